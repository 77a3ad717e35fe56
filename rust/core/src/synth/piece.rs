//! The samples of one piece of the recording: noise, bands, filter, quantiser.

use super::filter::Filter;
use super::motion::{Motion, SEGMENT};
use super::render::Chips;
use super::wave::{mix, Rotation};
use super::Synthesizer;
use crate::simd::synth::Loops;

/// Buffers of one thread.
#[derive(Default)]
pub(super) struct Workspace {
    chips: Chips,
    diff: Vec<i64>,
    /// Signals and noise of unit variance before the filter, from the first sample that the filter
    /// still needs; Q is empty if real.
    raw: [Vec<f32>; 2],
    filtered: [Vec<f32>; 2],
    /// I and Q interleaved, or what the filter needs.
    scratch: Vec<f32>,
}

impl Synthesizer {
    fn loops(&self) -> Loops {
        Loops::new(self.level)
    }

    /// Bytes of the samples `at..to`.
    pub(super) fn piece(&self, workspace: &mut Workspace, at: i64, to: i64, out: &mut [u8]) {
        workspace.raw.iter_mut().for_each(Vec::clear);
        let reach = self.config.filter.as_ref().map_or(0, Filter::reach) as i64;
        let bits = self.config.format.bits_per_sample();
        let (mut from, end) = (at - reach, to + reach);
        let (mut done, mut out) = (at, out);
        while from < end {
            let upto = ((from.div_euclid(SEGMENT) + 1) * SEGMENT).min(end);
            self.add_segment(workspace, from, upto);
            // Whole bytes, whatever the format.
            let ready = if upto == end { to } else { (upto - reach) & !3 };
            if ready > done {
                let count = (ready - done) as usize;
                let (part, rest) = out.split_at_mut(count * bits / 8);
                self.finish(workspace, done, count, part);
                (done, out) = (ready, rest);
            }
            from = upto;
        }
    }

    /// Appends the samples `from..to`, of one segment, to the raw ones.
    fn add_segment(&self, workspace: &mut Workspace, from: i64, to: i64) {
        let Workspace {
            chips, diff, raw, ..
        } = workspace;
        let (count, loops) = ((to - from) as usize, self.loops());
        let parts = 1 + usize::from(self.config.format.is_complex());
        let segment = from.div_euclid(SEGMENT);
        for (raw, noise) in raw.iter_mut().zip(&self.noise).take(parts) {
            let start = raw.len();
            raw.resize(start + count, 0.0);
            if self.config.noise {
                noise.fill(loops, from, &mut raw[start..]);
                self.raise(segment, &mut raw[start..]);
            }
        }
        let [re, im] = raw;
        let start = re.len() - count;
        let (re, im) = (&mut re[start..], im.get_mut(start..).unwrap_or_default());
        let part = (from - segment * SEGMENT, to - segment * SEGMENT);
        diff.resize(count + 1, 0);
        for band in &self.bands {
            for composite in &band.composites {
                let motion = Motion::new(&composite.lead, segment, self.config.sample_rate_hz);
                composite.render(loops, &motion, part, chips, diff);
            }
            let lo = Rotation {
                phase: 0,
                step: band.step,
            };
            mix(loops, &mut diff[..count], lo.after(from), re, im);
            diff[count] = 0; // the entry past the samples, which the sum does not reach
        }
    }

    /// Noise of a segment to its level there.
    fn raise(&self, segment: i64, noise: &mut [f32]) {
        if self.drive.noise_is_steady() {
            return;
        }
        let middle = (segment as f64 + 0.5) * SEGMENT as f64 / self.config.sample_rate_hz;
        let ratio = self.drive.noise_power(middle).sqrt() as f32;
        noise.iter_mut().for_each(|n| *n *= ratio);
    }

    /// Filters and quantises `count` samples from sample `at` on and forgets them.
    fn finish(&self, workspace: &mut Workspace, at: i64, count: usize, out: &mut [u8]) {
        let Workspace {
            raw,
            filtered,
            scratch,
            ..
        } = workspace;
        let complex = self.config.format.is_complex();
        let mut gain = self.config.noise_rms_lsb;
        let [re, im] = &*raw;
        let (mut values, mut quadrature) = (&re[..count], im.get(..count).unwrap_or_default());
        if let Some(filter) = &self.config.filter {
            gain /= filter.noise_gain();
            let all = count + 2 * filter.reach();
            let [out_re, out_im] = filtered;
            out_re.resize(count, 0.0);
            if complex {
                out_im.resize(count, 0.0);
                scratch.resize(count, 0.0);
                let x = [&re[..all], &im[..all]];
                filter.apply_complex(self.level, x, [out_re, out_im], scratch);
            } else {
                filter.apply_real(self.level, &re[..all], out_re);
            }
            (values, quadrature) = (out_re, out_im);
        }
        if complex {
            scratch.resize(2 * count, 0.0);
            let pairs = scratch.chunks_exact_mut(2).zip(values).zip(quadrature);
            pairs.for_each(|((pair, &i), &q)| pair.copy_from_slice(&[i, q]));
            values = scratch;
        }
        self.quantise(at, values, gain, out);
        for raw in raw {
            raw.drain(..count.min(raw.len()));
        }
    }

    /// Quantises values from sample `at` on, I and Q interleaved if complex.
    fn quantise(&self, at: i64, values: &[f32], gain: f64, out: &mut [u8]) {
        let (format, loops) = (self.config.format, self.loops());
        let Some(control) = &self.drive.gain else {
            return loops.pack(format, values, gain as f32, out);
        };
        let (parts, bits) = (
            1 + usize::from(format.is_complex()),
            format.bits_per_sample(),
        );
        let (mut at, mut values, mut out) = (at, values, out);
        while !values.is_empty() {
            let (ratio, left) = control.at_sample(at);
            let count = left.min(values.len() / parts);
            let (now, later) = values.split_at(count * parts);
            let (bytes, rest) = out.split_at_mut(count * bits / 8);
            loops.pack(format, now, (gain * ratio) as f32, bytes);
            (at, values, out) = (at + count as i64, later, rest);
        }
    }
}
