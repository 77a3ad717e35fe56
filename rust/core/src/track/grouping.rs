//! Targets to channels, and channels to threads.

use super::channel::Channel;
use super::config::TrackConfig;
use super::input::{Input, Target};
use super::sideband::Sideband;
use crate::{Error, Result};

/// The channels of all targets: one for each pair, and one for each other signal.
pub(super) fn channels(
    input: &Input,
    config: &TrackConfig,
    targets: &[Target],
) -> Result<Vec<Channel>> {
    let fs = input.sample_rate_hz;
    let sideband = |target: &Target| {
        let spec = target.check(fs)?;
        let sideband = Sideband::new(spec, target.prn, fs, config, target.seed, input.start)?;
        Ok((target.prn, sideband))
    };
    let sidebands: Result<Vec<_>> = targets.iter().map(sideband).collect();
    Ok(group(sidebands?, config, fs))
}

/// Channels of sidebands (with the numbers of their satellites), coupled where they can be.
pub(crate) fn group(
    sidebands: Vec<(u16, Sideband)>,
    config: &TrackConfig,
    sample_rate_hz: f64,
) -> Vec<Channel> {
    let mut satellites: Vec<((char, u16), Vec<Sideband>)> = Vec::new();
    for (prn, sideband) in sidebands {
        let key = (sideband.spec.system, prn);
        match satellites.iter_mut().find(|s| s.0 == key) {
            Some(satellite) => satellite.1.push(sideband),
            None => satellites.push((key, vec![sideband])),
        }
    }
    satellites
        .into_iter()
        .flat_map(|((_, prn), sidebands)| {
            let channel = move |s| Channel::new(prn, s, config, sample_rate_hz);
            coupled(sidebands, &config.pairs).into_iter().map(channel)
        })
        .collect()
}

/// Shares channels out among threads, the work as even as can be; and says where each went.
pub(super) fn shared_out(
    channels: Vec<Channel>,
    threads: usize,
) -> (Vec<Vec<Channel>>, Vec<(usize, usize)>) {
    let mut groups: Vec<Vec<Channel>> = Vec::new();
    groups.resize_with(threads.clamp(1, channels.len().max(1)), Vec::new);
    let mut order = Vec::new();
    for channel in channels {
        let work = |g: &Vec<Channel>| g.iter().map(|c| c.sidebands.len()).sum::<usize>();
        let least = (0..groups.len())
            .min_by_key(|&g| work(&groups[g]))
            .unwrap_or(0);
        order.push((least, groups[least].len()));
        groups[least].push(channel);
    }
    (groups, order)
}

/// Groups a satellite's sidebands: first those that are to be coupled, the lower carrier first, then
/// the others by carrier, the stronger first where a carrier has several.
fn coupled(mut sidebands: Vec<Sideband>, pairs: &[(String, String)]) -> Vec<Vec<Sideband>> {
    let key = |s: &Sideband| (s.spec.carrier_hz, -s.spec.power_share);
    sidebands.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut groups = Vec::new();
    for (a, b) in pairs {
        let place =
            |sidebands: &[Sideband], id: &str| sidebands.iter().position(|s| s.spec.id == id);
        if let (Some(_), Some(at)) = (place(&sidebands, a), place(&sidebands, b)) {
            let second = sidebands.remove(at);
            let first = place(&sidebands, a).map(|at| sidebands.remove(at));
            let mut pair: Vec<Sideband> = first.into_iter().chain([second]).collect();
            pair.sort_by(|x, y| x.spec.carrier_hz.total_cmp(&y.spec.carrier_hz));
            groups.push(pair);
        }
    }
    groups.extend(sidebands.into_iter().map(|s| vec![s]));
    groups
}

/// The channel of a signal, and which of its sidebands it is.
pub(crate) fn place<'a>(
    channels: impl Iterator<Item = &'a mut Channel>,
    system: char,
    prn: u16,
    signal: &str,
) -> Result<(&'a mut Channel, usize)> {
    let of = |s: &Sideband| s.spec.id == signal && s.spec.system == system;
    channels
        .filter(|c| c.prn == prn)
        .find_map(|c| c.sidebands.iter().position(of).map(|i| (c, i)))
        .ok_or_else(|| not_tracked(signal, system, prn))
}

/// Lets the pairs of a satellite be joined again.
pub(crate) fn rejoin<'a>(
    channels: impl Iterator<Item = &'a mut Channel>,
    system: char,
    prn: u16,
) -> Result<()> {
    let of = |c: &&mut Channel| c.prn == prn && c.sidebands[0].spec.system == system;
    let found = channels.filter(of).map(Channel::rejoin).count();
    (found > 0)
        .then_some(())
        .ok_or_else(|| not_tracked("any signal", system, prn))
}

fn not_tracked(signal: &str, system: char, prn: u16) -> Error {
    Error::Invalid(format!("{signal} of {system}{prn:02} is not tracked"))
}
