//! Any number of channels on the bands of a recording: the correlator as a whole, without loops.

use super::band::Band;
use super::correlator::{Correlator, Slice, FARTHEST_TAP};
use super::front_end::{FrontEnd, Stream};
use crate::simd::Level;

/// A channel of an [`Engine`]; of no other, and of none once it is detached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ChannelId(u64);

#[derive(Debug)]
struct Attached {
    id: ChannelId,
    band: usize,
    channel: Correlator,
}

/// Front ends and channels of one thread; more threads have an engine each.
#[derive(Debug)]
pub struct Engine {
    front: FrontEnd,
    reach: usize,
    channels: Vec<Attached>,
    ids: u64,
}

impl Engine {
    /// An engine for bands at the given frequencies (cycles per sample of the recording).
    ///
    /// No tap may lie farther than `reach` samples from its channel's prompt.
    ///
    /// # Panics
    /// If `reach` is more than [`FARTHEST_TAP`], a frequency not finite, or the stream starts after
    /// [`super::band::LAST_SAMPLE`].
    pub fn new(stream: Stream, frequencies: &[f64], reach: usize, level: Level) -> Self {
        assert!(
            reach <= FARTHEST_TAP,
            "taps {reach} samples from the prompt"
        );
        Engine {
            front: FrontEnd::new(stream, frequencies, FrontEnd::history(reach), level),
            reach,
            channels: Vec::new(),
            ids: 0,
        }
    }

    /// Adds a channel on a band. It must start no more than `reach` samples before what has been
    /// fed.
    ///
    /// # Panics
    /// If there is no such band, a tap is farther than `reach`, or samples that the channel needs
    /// are no longer held.
    pub fn attach(&mut self, band: usize, channel: Correlator) -> ChannelId {
        let bands = self.front.bands();
        assert!(band < bands.len(), "there is no band {band}");
        assert!(
            channel.reach() <= self.reach,
            "a channel with a tap {} samples from its prompt in an engine for {}",
            channel.reach(),
            self.reach
        );
        let held = bands[band].end() as i64 - FrontEnd::history(self.reach) as i64;
        assert!(
            channel.oldest() >= held,
            "a channel needs sample {} of an engine that holds those from {held}",
            channel.oldest()
        );
        let id = ChannelId(self.ids);
        self.ids += 1;
        self.channels.push(Attached { id, band, channel });
        id
    }

    /// Takes a channel out.
    pub fn detach(&mut self, id: ChannelId) -> Option<Correlator> {
        let at = self.channels.iter().position(|c| c.id == id)?;
        Some(self.channels.remove(at).channel)
    }

    /// Absorbs raw bytes of whole samples. `closed` gets every slice that a channel completes, and
    /// the channel, to steer it before the next.
    ///
    /// # Panics
    /// If the bytes are not those of whole samples, or a channel has no rates or was moved back to
    /// samples that are no longer held.
    pub fn feed(
        &mut self,
        bytes: &[u8],
        mut closed: impl FnMut(ChannelId, &Slice, &mut Correlator),
    ) {
        let channels = &mut self.channels;
        self.front.feed(bytes, |bands: &[Band]| {
            for Attached { id, band, channel } in channels.iter_mut() {
                channel.work_off(&bands[*band], |slice, c| closed(*id, slice, c));
            }
        });
    }

    /// The bands, to be retuned between calls of [`Engine::feed`].
    pub fn bands_mut(&mut self) -> &mut [Band] {
        self.front.bands_mut()
    }
}
