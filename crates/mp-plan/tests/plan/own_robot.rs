//! A kind of robot that is none of ours: a crane with a boom that turns and a trolley that slides, among posts.

use mp_cspace::{
    Clearance, Configuration, JointRange, Joints, KnownFree, MotionCheck, MotionClearance, MotionValidity,
    Validity,
};
use mp_plan::{
    Appearance, Body, BodyShape, Column, Contact, Control, Description, Error, Finish, Length, Measured,
    MetricName, Motion, PathRows, Queries, Request, Scene, TypedMotion,
};
use nalgebra::{Isometry3, Point2, Translation3, UnitQuaternion, Vector2, Vector3};

/// Radius of the load, metres.
const LOAD: f64 = 0.3;
/// The farthest place of the trolley, metres.
const BOOM: f64 = 5.0;
const TOLERANCE: f64 = 1e-3;

#[derive(Clone, Debug)]
struct Crane {
    space: Joints<Configuration>,
    ends: [Configuration; 2],
    check: Load,
    sampled: Option<Length>,
}

#[derive(Clone, Debug)]
struct Load {
    posts: Vec<Vector2<f64>>,
    /// How many posts, from the first one on, the check of the planner does not see.
    unseen: usize,
    /// Whether only collisions are known.
    blind: bool,
    queries: u64,
}

impl Load {
    fn least(&mut self, q: &Configuration) -> f64 {
        self.queries += 1;
        let load = place(q);
        self.posts[self.unseen..].iter().map(|post| (post - load).norm() - LOAD).fold(f64::INFINITY, f64::min)
    }
}

fn place(q: &Configuration) -> Vector2<f64> {
    let (sine, cosine) = mp_math::sin_cos(q[0]);
    Vector2::new(q[1] * cosine, q[1] * sine)
}

impl Validity<Configuration> for Load {
    fn is_valid(&mut self, q: &Configuration) -> bool {
        self.least(q) > 0.0
    }
}
impl Clearance<Configuration> for Load {
    fn clearance(&mut self, q: &Configuration, _: f64) -> f64 {
        if self.blind { 0.0 } else { self.least(q) }
    }
}
impl MotionClearance<Configuration> for Load {
    fn motion_bound(&self, from: &Configuration, to: &Configuration) -> f64 {
        (to[0] - from[0]).abs() * from[1].max(to[1]) + (to[1] - from[1]).abs()
    }
}
impl Queries for Load {
    fn queries(&self) -> u64 {
        self.queries
    }
}

/// The verifier: fine steps, in its own words.
#[derive(Clone)]
struct Steps<'c>(&'c Crane);

impl MotionValidity<Configuration> for Steps<'_> {
    fn check_motion(&mut self, a: &Configuration, b: &Configuration) -> MotionCheck {
        self.check_extension(a, b, KnownFree::Neither)
    }
    fn check_extension(&mut self, a: &Configuration, b: &Configuration, _: KnownFree) -> MotionCheck {
        let mut least = f64::INFINITY;
        for i in 0..=2000 {
            let at = f64::from(i) / 2000.0;
            let (turn, reach) = (a[0] + at * (b[0] - a[0]), a[1] + at * (b[1] - a[1]));
            let (sine, cosine) = mp_math::sin_cos(turn);
            for post in &self.0.check.posts {
                let clearance = mp_math::hypot(post.x - reach * cosine, post.y - reach * sine) - LOAD;
                least = least.min(clearance);
                if clearance <= 0.0 {
                    return MotionCheck::Collision { at };
                }
            }
        }
        MotionCheck::Free { clearance: least }
    }
}

impl TypedMotion for Crane {
    type Space = Joints<Configuration>;
    type Checker = Load;
    type Verifier<'c> = Steps<'c>;
    fn space(&self) -> &Self::Space {
        &self.space
    }
    fn checker(&self) -> &Load {
        &self.check
    }
    fn verifier(&self) -> Result<Steps<'_>, Error> {
        Ok(Steps(self))
    }
}

impl Motion for Crane {
    fn start(&self) -> &Configuration {
        &self.ends[0]
    }
    fn goals(&self) -> &[Configuration] {
        &self.ends[1..]
    }
    fn tolerance(&self) -> f64 {
        TOLERANCE
    }
    fn sampled(&self) -> Option<Length> {
        self.sampled
    }
    fn measured(&self, _: MetricName) -> Result<Measured<'_>, Error> {
        Ok(Measured::new(&self.space))
    }
    fn nearest_free(&self, _: &Configuration) -> Option<Configuration> {
        None
    }
}

impl Description for Crane {
    fn name(&self) -> &str {
        "crane"
    }
    fn space_name(&self) -> String {
        "crane".to_owned()
    }
    fn touching(&self, q: &Configuration) -> Vec<Contact> {
        let near = |(_, post): &(usize, &Vector2<f64>)| (*post - place(q)).norm() <= LOAD;
        let posts = self.check.posts.iter().enumerate().filter(near);
        let touch =
            |(i, _)| Contact { part: None, other: format!("post {i}"), with_itself: false, depth: None };
        posts.map(touch).collect()
    }
    fn columns(&self) -> Vec<Column> {
        vec![Column::new("turn", "rad"), Column::new("reach", "m")]
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        vec![Some([-3.0, 3.0]), Some([1.0, BOOM])]
    }
    fn row(&self, q: &Configuration) -> Vec<f64> {
        q.as_slice().to_vec()
    }
    fn state(&self, row: &[f64]) -> Configuration {
        Configuration::from(row)
    }
}

impl Appearance for Crane {
    fn bodies(&self) -> Vec<Body> {
        let square = |half: f64| {
            let corner = |(x, y): (f64, f64)| Point2::new(x * half, y * half);
            vec![[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner).to_vec()]
        };
        let load = Body { name: "load".into(), shape: BodyShape::Area(square(LOAD)), pose: None };
        let post = |p: &Vector2<f64>| Body {
            name: "post".into(),
            shape: BodyShape::Area(square(0.05)),
            pose: Some(Isometry3::translation(p.x, p.y, 0.0)),
        };
        std::iter::once(load).chain(self.check.posts.iter().map(post)).collect()
    }
    fn poses(&self, q: &Configuration) -> Vec<Isometry3<f64>> {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), q[0]);
        vec![Isometry3::from_parts(Translation3::new(place(q).x, place(q).y, 0.0), turn)]
    }
    fn picture_spacing(&self) -> f64 {
        LOAD
    }
}

fn crane(goal: [f64; 2]) -> Crane {
    let ranges =
        [JointRange::Interval { low: -3.0, high: 3.0 }, JointRange::Interval { low: 1.0, high: BOOM }];
    Crane {
        space: Joints::new(ranges).unwrap(),
        ends: [Configuration::from(vec![-1.0, 4.0]), Configuration::from(goal.to_vec())],
        check: Load {
            posts: (0..8).map(|i| Vector2::new(1.6 + 0.4 * f64::from(i), 0.0)).collect(),
            unseen: 0,
            blind: false,
            queries: 0,
        },
        sampled: None,
    }
}

#[test]
fn a_robot_of_ones_own_is_planned_for_by_every_planner_that_needs_no_more() {
    let scene = Scene::new(crane([1.0, 4.0]));
    for planner in ["rrt-connect", "rrt", "rrt-star", "rsrt", "or-rrt-connect", "prm", "visibility-prm"] {
        let report = scene.plan(&Request::new(planner).iterations(5_000)).unwrap_or_else(|e| panic!("{e}"));
        assert!(report.solved && report.collision_checks > 0, "{planner}: {report:?}");
        let rows = report.path.unwrap();
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        let verdict = scene.check(&path).unwrap();
        assert!(verdict.free, "{planner}: {verdict:?}");
        // It had to move the load in or out to pass the posts.
        assert!(path.rows.iter().any(|row| row[1] < 1.6 || row[1] > 4.4), "{planner}");
    }
    for (planner, lacks) in [("rrs", "gradient"), ("obrrt", "hints"), ("obprm", "obstacles")] {
        let error = scene.plan(&Request::new(planner).iterations(10)).unwrap_err();
        assert!(error.to_string().contains(lacks), "{planner}: {error}");
    }
}

#[test]
fn what_is_wrong_is_explained() {
    let error = Scene::new(crane([0.0, 4.0])).plan(&Request::default()).unwrap_err();
    assert!(error.message().contains("the goal is in collision with post"), "{error}");
    let scene = Scene::new(crane([1.0, 4.0]));
    let through = PathRows {
        format: scene.path_format(),
        columns: vec![],
        rows: vec![vec![-1.0, 4.0], vec![1.0, 4.0]],
    };
    let verdict = scene.check(&through).unwrap();
    assert!(!verdict.free && verdict.faults[0].contains("hits post"), "{verdict:?}");
    assert!(scene.explain(&[9.0, 4.0]).unwrap().fault.unwrap().contains("out of bounds"));
    assert!(scene.explain(&[9.0]).unwrap_err().remedy().unwrap().contains("turn [rad]"));
    assert!(scene.lint().is_empty(), "{:?}", scene.lint());
}

/// The path is proved once, after the search. Where that fails, the search is made again, and goes on behind what is rejected.
#[test]
fn what_the_verifier_rejects_is_searched_on() {
    let mut crane = crane([1.0, 4.0]);
    crane.check.unseen = crane.check.posts.len();
    let scene = Scene::new(crane);
    for planner in ["rrt-connect", "rrt", "or-rrt-connect"] {
        let request = Request::new(planner).iterations(5_000);
        let report = scene.plan(&request).unwrap_or_else(|e| panic!("{e}"));
        assert!(report.solved && report.rejected > 0, "{planner}: {report:?}");
        let prepared = scene.prepare(&request).unwrap();
        let mut run = prepared.begin(&mut Control::default()).unwrap();
        while !run.advance(&mut mp_cspace::Iterations(u64::MAX), &mut Control::default()) {}
        let in_pieces = run.finish(&mut Control::default()).unwrap();
        assert_eq!(in_pieces.fingerprint, report.fingerprint, "{planner}");
        let rows = report.path.unwrap();
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        assert!(scene.check(&path).unwrap().free, "{planner}");
    }
    // As long as nothing is rejected, the search has proved nothing.
    let unproved = Request::new("rrt-connect").iterations(1);
    assert_eq!(scene.plan(&unproved).unwrap().stopped_by, Some(mp_plan::StoppedBy::Iterations));
}

/// The same crane without clearance: motions are sampled.
fn sampled(goal: [f64; 2]) -> Scene {
    let mut crane = crane(goal);
    (crane.check.blind, crane.sampled) = (true, Some(Length::Fraction(0.01)));
    Scene::new(crane)
}

#[test]
fn where_no_clearance_is_known_motions_are_sampled() {
    let scene = sampled([1.0, 4.0]);
    for planner in ["rrt-connect", "rrt-star", "prm", "visibility-prm"] {
        let report = scene.plan(&Request::new(planner).iterations(5_000)).unwrap_or_else(|e| panic!("{e}"));
        assert!(report.solved && report.motion == "discrete:1%", "{planner}: {report:?}");
        assert!(report.clearance.is_none() && report.shortened, "{planner}: {report:?}");
        let rows = report.path.unwrap();
        let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        let verdict = scene.check(&path).unwrap();
        assert!(verdict.free, "{planner}: {verdict:?}");
        assert!(path.rows.iter().any(|row| row[1] < 1.6 || row[1] > 4.4), "{planner}");
    }
    assert!(scene.explain(&[-1.0, 4.0]).unwrap().free);
    let error = sampled([0.0, 4.0]).plan(&Request::default()).unwrap_err();
    assert_eq!(error.message(), "the goal is in collision");
    let error = scene.plan(&Request::default().finish(Finish::Relax)).unwrap_err();
    assert!(error.message().contains("gradient"), "{error}");
}

#[test]
fn paths_from_elsewhere_are_finished() {
    for scene in [Scene::new(crane([1.0, 4.0])), sampled([1.0, 4.0])] {
        let path =
            |rows: Vec<Vec<f64>>| PathRows { format: scene.path_format(), columns: scene.columns(), rows };
        // Its ends are not those of the scene.
        let detour = [[-0.5, 3.0], [-2.0, 4.9], [-0.9, 4.95], [0.9, 4.95], [2.0, 4.9], [0.5, 3.0]];
        let detour = path(detour.map(|row| row.to_vec()).to_vec());
        let finished = scene.finish(&detour, &Request::default(), &mut Control::default()).unwrap();
        assert!(finished.shortened && finished.length < 5.0, "{finished:?}");
        assert_eq!(
            (finished.path.rows.first(), finished.path.rows.last()),
            (detour.rows.first(), detour.rows.last())
        );
        let faults = scene.check(&finished.path).unwrap().faults;
        assert!(faults.iter().all(|fault| fault.contains("does not")), "{faults:?}");
        let kept = Request::default().finish(Finish::AsFound);
        assert_eq!(scene.finish(&detour, &kept, &mut Control::default()).unwrap().path.rows, detour.rows);

        let through = path(vec![vec![-0.5, 3.0], vec![0.5, 3.0]]);
        let error = scene.finish(&through, &Request::default(), &mut Control::default()).unwrap_err();
        assert!(error.message().contains("between configurations 1 and 2"), "{error}");
    }
    let scene = Scene::find("easy").unwrap();
    let rows = scene.plan(&Request::default()).unwrap().path.unwrap();
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    let mut stopped = Control::default();
    stopped.cancel.cancel();
    let error = scene.finish(&path, &Request::default(), &mut stopped).unwrap_err();
    assert!(error.message().contains("not verified"), "{error}");
}
