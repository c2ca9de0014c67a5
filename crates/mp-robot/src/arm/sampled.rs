//! Which links may touch, found by sampling, as MoveIt's Setup Assistant does; and the SRDF that says so.

use super::pairs::{Joined, base_frame, joined};
use super::robot::{LinkBody, SharedArm, are_nested};
use super::{ArmError, ArmModel, Kinematics};
use mp_collide::Query;
use mp_cspace::{Configuration, Halton, Interrupt, Joints, Rng, Sampler};
use std::fmt::{self, Write as _};

/// The fewest and the most configurations looked at. From the fewest on, they are doubled until nothing changes.
const FEWEST: u64 = 8_000;
const MOST: u64 = 256_000;
/// Links that touch in this share of the configurations are said to touch always.
const ALWAYS: f64 = 0.95;

/// Why two links may touch: the reasons of MoveIt's Setup Assistant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TouchReason {
    /// A joint connects them, or the rigid bodies that they are parts of.
    Adjacent,
    /// They touch at the neutral configuration: all joints at zero, or at the limit nearest to it.
    Default,
    /// They touch in at least 95% of the configurations.
    Always,
    /// They touch in none of the configurations. No proof that they never do: it makes checks faster.
    Never,
}

impl fmt::Display for TouchReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Adjacent => "Adjacent",
            Self::Default => "Default",
            Self::Always => "Always",
            Self::Never => "Never",
        })
    }
}

/// Two links, and how often they touch.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledPair {
    /// The names of the links.
    pub links: [String; 2],
    /// In which share of the configurations they touch, 0 to 1; zero for adjacent ones, which are not looked at.
    pub share: f64,
    /// Why they may touch; `None` if they touch in some configurations and not in others, and so must be compared.
    pub reason: Option<TouchReason>,
}

/// All pairs of links that have shapes, from [`ArmModel::sampled_pairs`].
#[derive(Clone, Debug, PartialEq)]
pub struct SampledPairs {
    /// The number of configurations looked at.
    pub samples: u64,
    /// The pairs, in the order of the links.
    pub pairs: Vec<SampledPair>,
}

impl ArmModel {
    /// Finds which links may touch: looks at the neutral configuration and at points of the Halton sequence, 8,000 of them, then twice
    /// as many until no pair has another reason than before. The same robot always has the same answer. What the model
    /// says of pairs is left aside. O(samples · pairs) collision queries.
    ///
    /// # Errors
    /// As [`Arm::new`](crate::Arm::new), and [`Interrupted`](ArmError::Interrupted) when it was interrupted.
    pub fn sampled_pairs(&self, interrupt: &Interrupt) -> Result<SampledPairs, ArmError> {
        let described = self.as_described().filter(|described| Kinematics::new(described).is_ok());
        let described = described.unwrap_or_else(|| self.clone());
        let model = Self { may_touch: None, kept_apart: Vec::new(), ..described };
        let robot = SharedArm::new(&model, interrupt)?;
        let base = base_frame(&robot.model, &robot.kinematics);
        let mut candidates = Vec::new();
        for (j, b) in robot.bodies.iter().enumerate() {
            for (i, a) in robot.bodies.iter().enumerate().take(j) {
                let rigid = a.frame == b.frame;
                let adjacent = !rigid && joined(&robot.kinematics, &robot.bodies, base, a, b) == Joined::Yes;
                candidates.push(Candidate { bodies: [i, j], adjacent, rigid, at_neutral: false, touched: 0 });
            }
        }
        let samples = look(&robot, &mut candidates, interrupt)?;
        let pair = |candidate: &Candidate| SampledPair {
            links: candidate.bodies.map(|body| robot.name(body).to_owned()),
            share: candidate.touched(samples) as f64 / samples as f64,
            reason: candidate.reason(samples),
        };
        Ok(SampledPairs { samples, pairs: candidates.iter().map(pair).collect() })
    }
}

/// A pair that is looked at.
struct Candidate {
    bodies: [usize; 2],
    adjacent: bool,
    /// Whether they never move relative to each other: looked at once.
    rigid: bool,
    at_neutral: bool,
    /// In how many configurations it touches.
    touched: u64,
}

impl Candidate {
    fn touched(&self, samples: u64) -> u64 {
        if self.rigid && self.at_neutral { samples } else { self.touched }
    }

    fn reason(&self, samples: u64) -> Option<TouchReason> {
        match self.touched(samples) {
            _ if self.adjacent => Some(TouchReason::Adjacent),
            touched if touched as f64 >= ALWAYS * samples as f64 => Some(TouchReason::Always),
            _ if self.at_neutral => Some(TouchReason::Default),
            0 => Some(TouchReason::Never),
            _ => None,
        }
    }
}

/// Counts how often each pair touches, until the reasons no longer change. Returns the number of configurations.
fn look(robot: &SharedArm, pairs: &mut [Candidate], interrupt: &Interrupt) -> Result<u64, ArmError> {
    let mut interrupt = interrupt.clone();
    let kinematics = &robot.kinematics;
    let space: Joints<Configuration> = kinematics.joints()?;
    let (mut halton, mut rng) = (Halton::new(&space), Rng::seed(0));
    let (mut query, mut frames) = (Query::default(), Vec::new());
    let mut q = Configuration::from(kinematics.neutral());
    let (mut samples, mut aim, mut before) = (0, FEWEST, Vec::new());
    loop {
        while samples < aim {
            kinematics.frames_from(&kinematics.base, q.as_slice(), &mut frames);
            interrupt.go_on()?;
            let looked_at = |pair: &&mut Candidate| !pair.adjacent && (!pair.rigid || samples == 0);
            for pair in pairs.iter_mut().filter(looked_at) {
                let touches = touch(&mut query, pair.bodies.map(|body| &robot.bodies[body]), &frames);
                pair.touched += u64::from(touches);
                pair.at_neutral |= touches && samples == 0;
            }
            samples += 1;
            q = halton.sample(&mut rng);
        }
        let now: Vec<_> = pairs.iter().map(|pair| pair.reason(samples)).collect();
        if now == before || aim >= MOST {
            return Ok(samples);
        }
        (before, aim) = (now, 2 * aim);
    }
}

/// Whether two links touch, or one is inside the other, a solid.
fn touch(query: &mut Query, [a, b]: [&LinkBody; 2], frames: &[nalgebra::Isometry3<f64>]) -> bool {
    let (ball_a, ball_b) = (a.ball_at(frames), b.ball_at(frames));
    let reach = ball_a.radius + ball_b.radius;
    (ball_a.center - ball_b.center).norm_squared() <= reach * reach
        && (query.intersects(&a.tree, &frames[a.frame], &b.tree, &frames[b.frame])
            || are_nested(query, [a, b], frames))
}

impl SampledPairs {
    /// How many pairs may touch for this reason.
    #[must_use]
    pub fn count(&self, reason: TouchReason) -> usize {
        self.pairs.iter().filter(|pair| pair.reason == Some(reason)).count()
    }

    /// An SRDF of the robot `name` that allows the pairs which have a reason, with their shares in comments. Without `never`, pairs that
    /// were not seen to touch are left out, and so go on being compared.
    #[must_use]
    pub fn srdf(&self, name: &str, never: bool) -> String {
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<!-- Which links may touch, from {} configurations: all joints at zero, and points of the \
             Halton sequence. -->\n<robot name=\"{}\">\n",
            self.samples,
            escaped(name)
        );
        for pair in &self.pairs {
            let Some(reason) = pair.reason.filter(|reason| never || *reason != TouchReason::Never) else {
                continue;
            };
            let [a, b] = pair.links.each_ref().map(|link| escaped(link));
            let share = match reason {
                TouchReason::Always | TouchReason::Default => {
                    format!(" <!-- in {:.1}% of them -->", 100.0 * pair.share)
                }
                TouchReason::Adjacent | TouchReason::Never => String::new(),
            };
            let _ = writeln!(
                text,
                "  <disable_collisions link1=\"{a}\" link2=\"{b}\" reason=\"{reason}\"/>{share}"
            );
        }
        text + "</robot>\n"
    }
}

/// The text as it stands in an attribute of XML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
