//! Which taps a correlator loads together.

use super::ring::LANES;

/// How taps lie in groups of eight, 8 samples apart, that cost one load each.
#[derive(Debug, Default)]
pub(super) struct TapPlan {
    /// Offset of each group's first lane.
    pub(super) groups: Vec<i64>,
    /// Tap, and the group and lane where its sum is.
    pub(super) places: Vec<(usize, usize, usize)>,
}

impl TapPlan {
    /// A plan for taps, by their index and offset.
    pub(super) fn new(taps: impl Iterator<Item = (usize, i64)>) -> Self {
        let mut taps: Vec<_> = taps.collect();
        taps.sort_by_key(|tap| tap.1);
        let mut plan = TapPlan::default();
        for (tap, offset) in taps {
            let lane = |&group: &i64| {
                let distance = offset - group;
                let lane = distance as usize / LANES;
                (distance % LANES as i64 == 0 && lane < LANES).then_some(lane)
            };
            let mut known = plan.groups.iter().enumerate();
            let place = known.find_map(|(g, first)| lane(first).map(|l| (tap, g, l)));
            plan.places
                .push(place.unwrap_or((tap, plan.groups.len(), 0)));
            if place.is_none() {
                plan.groups.push(offset);
            }
        }
        plan
    }
}
