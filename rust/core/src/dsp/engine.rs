//! Any number of channels on the bands of a recording: the correlator as a whole, without loops.

use super::band::Band;
use super::correlator::{Correlator, Slice};
use super::front_end::{FrontEnd, Stream};
use crate::simd::Level;

/// A channel of an [`Engine`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ChannelId(usize);

/// Front ends and channels of one thread; more threads have an engine each.
#[derive(Debug)]
pub struct Engine {
    front: FrontEnd,
    /// Band and correlator.
    channels: Vec<Option<(usize, Correlator)>>,
}

impl Engine {
    /// An engine for bands at the given frequencies (cycles per sample of the recording).
    ///
    /// No tap may lie farther than `reach` samples from its channel's prompt.
    pub fn new(stream: Stream, frequencies: &[f64], reach: usize, level: Level) -> Self {
        Engine {
            front: FrontEnd::new(stream, frequencies, FrontEnd::history(reach), level),
            channels: Vec::new(),
        }
    }

    /// Adds a channel on a band. It must start no more than `reach` samples before what has been
    /// fed.
    ///
    /// # Panics
    /// If there is no such band.
    pub fn attach(&mut self, band: usize, channel: Correlator) -> ChannelId {
        assert!(band < self.front.bands().len(), "there is no band {band}");
        let free = self.channels.iter().position(Option::is_none);
        let at = free.unwrap_or(self.channels.len());
        if free.is_none() {
            self.channels.push(None);
        }
        self.channels[at] = Some((band, channel));
        ChannelId(at)
    }

    /// Takes a channel out.
    pub fn detach(&mut self, id: ChannelId) -> Option<Correlator> {
        let channel = self.channels.get_mut(id.0)?.take()?;
        Some(channel.1)
    }

    /// Absorbs raw bytes of whole samples. `closed` gets every slice that a channel completes, and
    /// the channel, to steer it before the next.
    pub fn feed(
        &mut self,
        bytes: &[u8],
        mut closed: impl FnMut(ChannelId, &Slice, &mut Correlator),
    ) {
        let channels = &mut self.channels;
        self.front.feed(bytes, |bands: &[Band]| {
            for (id, channel) in channels.iter_mut().enumerate() {
                if let Some((band, channel)) = channel {
                    channel.work_off(&bands[*band], |slice, c| closed(ChannelId(id), slice, c));
                }
            }
        });
    }

    /// The bands, to be retuned between calls of [`Engine::feed`].
    pub fn bands_mut(&mut self) -> &mut [Band] {
        self.front.bands_mut()
    }
}
