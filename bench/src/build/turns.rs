//! All ways to build take turns. A turn builds twice and then asks the tree: whoever answers wrongly gets no time.

use raywood_lab::Timing;
use raywood_lab::timing::seconds;

use crate::answers::{Agreement, Answers};
use crate::memory::give_back;
use crate::peers::builds::{BuildEntry, Builder, Cost, Prepared};
use crate::peers::{Mode, Tracer};
use crate::ray_sets::{RaySet, SetKind};

/// Who takes longer than this for a build takes part in fewer rounds.
const SLOW: &[(f64, usize)] = &[(2.5, 1), (0.6, 3)];

/// The rays that every tree is asked.
pub(crate) struct Questions {
    /// With the answers of the reference.
    pub(crate) sets: Vec<(RaySet, Answers)>,
    /// Whether it counts how long that takes.
    pub(crate) timed: bool,
}

/// How one way to build did.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) peer: &'static str,
    pub(crate) preset: &'static str,
    pub(crate) outcome: Outcome,
}

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// Its trees answer rightly.
    Timed(Times),
    /// They do not: how.
    Wrong(String),
    /// There is none: why.
    Absent(String),
}

/// What a way to build takes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Times {
    /// Building where the same was built just before.
    pub(crate) warm: Timing,
    /// Building after others, with free memory given back.
    pub(crate) cold: Timing,
    /// The last build; its time is one of many.
    pub(crate) cost: Cost,
    /// What tracing through the tree takes; empty unless asked for.
    pub(crate) traces: Vec<Trace>,
}

/// How a mode did with one set of rays.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Trace {
    pub(crate) set: SetKind,
    pub(crate) rays: usize,
    pub(crate) mode: &'static str,
    pub(crate) watertight: bool,
    /// How long it takes, or how it is wrong.
    pub(crate) outcome: Result<(Timing, Agreement), String>,
}

impl Trace {
    /// Nanoseconds for each ray, on all threads together; nothing for who is wrong.
    pub(crate) fn ns_per_ray(&self) -> Option<f64> {
        let (timing, _) = self.outcome.as_ref().ok()?;
        Some(1e9 * timing.median() / self.rays.max(1) as f64)
    }
}

/// Lets all take turns in the current rayon pool, every other round backwards.
pub(crate) fn take_turns(
    mut contestants: Vec<(&'static BuildEntry, Prepared<'_>)>,
    questions: &Questions,
    rounds: usize,
) -> Vec<Row> {
    let mut turns: Vec<Result<Vec<Turn>, String>> =
        contestants.iter().map(|_| Ok(Vec::new())).collect();
    for round in 0..rounds {
        for place in 0..contestants.len() {
            let number = if round % 2 == 0 { place } else { contestants.len() - 1 - place };
            let Ok(builder) = &mut contestants[number].1 else { continue };
            let Ok(before) = &mut turns[number] else { continue };
            if round < before.first().map_or(rounds, |turn| turn.rounds(rounds)) {
                match take_turn(&mut **builder, questions) {
                    Ok(turn) => before.push(turn),
                    Err(why) => turns[number] = Err(why),
                }
            }
        }
    }
    let row = |((entry, prepared), turns): ((&'static BuildEntry, Prepared<'_>), _)| {
        let outcome = match prepared.and(turns) {
            Ok(turns) => outcome(turns, questions),
            Err(why) => Outcome::Absent(why),
        };
        Row { peer: entry.peer, preset: entry.preset, outcome }
    };
    contestants.into_iter().zip(turns).map(row).collect()
}

/// What one turn brought.
struct Turn {
    /// Seconds of the first build.
    cold: f64,
    /// The second build.
    cost: Cost,
    /// Every mode with every set that it traces, always in the same order.
    asked: Vec<Asked>,
}

struct Asked {
    set: usize,
    mode: &'static str,
    watertight: bool,
    /// Seconds, which may not count.
    outcome: Result<(f64, Agreement), String>,
}

impl Turn {
    /// How many of the rounds someone as slow as this takes part in.
    fn rounds(&self, rounds: usize) -> usize {
        let limit = SLOW.iter().find(|(seconds, _)| self.cost.seconds > *seconds);
        limit.map_or(rounds, |&(_, limit)| rounds.min(limit))
    }
}

fn take_turn(builder: &mut (dyn Builder + '_), questions: &Questions) -> Result<Turn, String> {
    give_back();
    let cold = builder.build()?.0.seconds;
    let (cost, tree) = builder.build()?;
    let mut asked = Vec::new();
    for mode in tree.modes() {
        for (set, (rays, expected)) in questions.sets.iter().enumerate() {
            let Mode { name, watertight, ref prepare } = mode;
            let Some(mut tracer) = prepare(rays) else { continue };
            let outcome = ask(&mut *tracer, expected);
            asked.push(Asked { set, mode: name, watertight, outcome });
        }
    }
    Ok(Turn { cold, cost, asked })
}

/// Traces by the clock, and looks whether the answers are right.
fn ask(tracer: &mut (dyn Tracer + '_), expected: &Answers) -> Result<(f64, Agreement), String> {
    tracer.reset();
    let (time, ()) = seconds(|| tracer.trace());
    let agreement = Agreement::of(expected, &tracer.answers())?;
    agreement.verdict()?;
    Ok((time, agreement))
}

/// All turns of one way to build together.
fn outcome(turns: Vec<Turn>, questions: &Questions) -> Outcome {
    let Some(last) = turns.last() else {
        return Outcome::Absent("there were no rounds".to_owned());
    };
    let traces: Vec<_> = last
        .asked
        .iter()
        .enumerate()
        .map(|(number, &Asked { set, mode, watertight, .. })| {
            let rays = &questions.sets[set].0;
            // Wrong once is wrong.
            let outcomes: Result<Vec<_>, _> =
                turns.iter().map(|turn| turn.asked[number].outcome.clone()).collect();
            let outcome = outcomes.map(|outcomes| {
                let (times, agreements): (Vec<_>, Vec<_>) = outcomes.into_iter().unzip();
                (Timing::new(times), agreements.last().copied().unwrap_or_default())
            });
            Trace { set: rays.kind, rays: rays.rays.len(), mode, watertight, outcome }
        })
        .collect();

    // A tree is right if every set has a mode that answers it rightly: modes differ in how they test triangles.
    for (rays, _) in &questions.sets {
        let mut of_set = traces.iter().filter(|trace| trace.set == rays.kind);
        if !of_set.clone().any(|trace| trace.outcome.is_ok()) {
            let why = of_set.find_map(|trace| trace.outcome.as_ref().err());
            let why = why.map_or("no answer", String::as_str);
            return Outcome::Wrong(format!("{}: {why}", rays.kind.name()));
        }
    }
    Outcome::Timed(Times {
        warm: Timing::new(turns.iter().map(|turn| turn.cost.seconds).collect()),
        cold: Timing::new(turns.iter().map(|turn| turn.cold).collect()),
        cost: last.cost,
        traces: if questions.timed { traces } else { Vec::new() },
    })
}

#[cfg(test)]
mod tests {
    use raywood::{Ray, TriangleMesh};

    use super::*;
    use crate::memory::Memory;
    use crate::peers::Peer;

    /// Builds trees that are right so often, in that many seconds.
    struct Fake {
        right: usize,
        seconds: f64,
        builds: usize,
    }

    struct Tree(f32);

    struct Rays(f32);

    impl Builder for Fake {
        fn build(&mut self) -> Result<(Cost, Box<dyn Peer + '_>), String> {
            self.builds += 1;
            let seconds = self.seconds + self.builds as f64;
            let tree = Tree(if self.builds <= self.right { 1.0 } else { 2.0 });
            Ok((Cost { seconds, memory: Memory::default(), q: None }, Box::new(tree)))
        }
    }

    impl Peer for Tree {
        fn modes(&self) -> Vec<Mode<'_>> {
            let mode = |name, distance| Mode {
                name,
                watertight: true,
                prepare: Box::new(move |_: &RaySet| {
                    Some(Box::new(Rays(distance)) as Box<dyn Tracer>)
                }),
            };
            vec![mode("right", self.0), mode("wrong", 3.0)]
        }
    }

    impl Tracer for Rays {
        fn reset(&mut self) {}

        fn trace(&mut self) {}

        fn answers(&self) -> Answers {
            Answers::Closest(vec![self.0; 100])
        }
    }

    fn questions() -> Questions {
        let rays = vec![Ray::new([0.0; 3], [1.0, 0.0, 0.0]); 100];
        let set = RaySet { kind: SetKind::Primary, rays, common: None };
        Questions { sets: vec![(set, Answers::Closest(vec![1.0; 100]))], timed: true }
    }

    fn row(prepare: for<'a> fn(&'a TriangleMesh) -> Prepared<'a>) -> Row {
        static ENTRY: BuildEntry = BuildEntry {
            peer: "fake",
            preset: "any",
            settings: "",
            prepare: |_, _| Err("absent".to_owned()),
        };
        let mesh = TriangleMesh::default();
        take_turns(vec![(&ENTRY, prepare(&mesh))], &questions(), 5).swap_remove(0)
    }

    #[test]
    fn who_is_right_gets_the_time_of_the_second_build_of_each_turn() {
        let row = row(|_| Ok(Box::new(Fake { right: 100, seconds: -6.0, builds: 0 })));
        let Outcome::Timed(times) = row.outcome else { panic!("{row:?}") };
        assert_eq!(times.cold, Timing::new(vec![-5.0, -3.0, -1.0, 1.0, 3.0]));
        assert_eq!(times.warm, Timing::new(vec![-4.0, -2.0, 0.0, 2.0, 4.0]));
        // The mode that is wrong does no harm, but has no time.
        let modes: Vec<_> =
            times.traces.iter().map(|trace| (trace.mode, trace.ns_per_ray().is_some())).collect();
        assert_eq!(modes, [("right", true), ("wrong", false)]);
    }

    #[test]
    fn wrong_trees_get_no_time_not_even_late_ones() {
        for right in [0, 9] {
            let prepare: for<'a> fn(&'a TriangleMesh) -> Prepared<'a> = match right {
                0 => |_| Ok(Box::new(Fake { right: 0, seconds: -10.0, builds: 0 })),
                _ => |_| Ok(Box::new(Fake { right: 9, seconds: -10.0, builds: 0 })),
            };
            assert!(matches!(row(prepare).outcome, Outcome::Wrong(_)), "{right}");
        }
        assert_eq!(row(|_| Err("why".into())).outcome, Outcome::Absent("why".into()));
    }

    #[test]
    fn slow_builds_take_part_in_fewer_rounds() {
        let row = row(|_| Ok(Box::new(Fake { right: 100, seconds: 100.0, builds: 0 })));
        let Outcome::Timed(times) = row.outcome else { panic!("{row:?}") };
        assert_eq!((times.warm.rounds(), times.cold.rounds()), (1, 1));
    }
}
