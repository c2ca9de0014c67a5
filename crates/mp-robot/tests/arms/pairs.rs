//! Which links are compared, and how near they may come.

use mp_cspace::Interrupt;
use mp_cspace::{Clearance, Configuration, MotionValidity, Validity};
use mp_geom::primitives::cuboid;
use mp_robot::{Arm, ArmModel, ArmVerifier, Joint, JointKind, Link, TouchReason};
use nalgebra::{Isometry3, Vector3};

const TURN: JointKind = JointKind::Revolute { low: -2.0, high: 2.0 };

fn block(name: &str, size: f64, height: f64) -> Link {
    Link::new(name).with(&cuboid(size, size, size).unwrap(), &Isometry3::translation(0.0, 0.0, height))
}

fn joint(name: &str, parent: &str, child: &str, kind: JointKind) -> Joint {
    Joint::new(name, parent, child, kind).axis(Vector3::z())
}

fn model(links: Vec<Link>, joints: Vec<Joint>) -> ArmModel {
    ArmModel { links, joints, ..ArmModel::default() }
}

fn compared(model: &ArmModel) -> Vec<String> {
    let arm = Arm::new(model, []).unwrap();
    arm.checked_pairs().into_iter().map(|[a, b]| format!("{a} {b}")).collect()
}

/// A link on a foot: `base`, then `carrier` by a joint that slides, with `shell` welded to it.
fn lift() -> ArmModel {
    let slide = JointKind::Prismatic { low: 0.0, high: 0.6 };
    let links = vec![block("base", 0.4, 0.0), Link::new("carrier"), block("shell", 0.3, 0.3)];
    model(
        links,
        vec![joint("up", "base", "carrier", slide), joint("weld", "carrier", "shell", JointKind::Fixed)],
    )
}

#[test]
fn welded_links_are_one_body_with_the_link_of_a_joint() {
    // Welded to the child, once, twice, and by a joint that is held.
    assert_eq!(compared(&lift()), [""; 0]);
    let mut twice = lift();
    twice.links.push(block("cap", 0.35, 0.2));
    twice.joints.push(joint("weld 2", "shell", "cap", JointKind::Fixed));
    assert_eq!(compared(&twice), [""; 0]);
    let mut held = lift();
    held.joints[1].kind = JointKind::Revolute { low: 0.5, high: 0.5 };
    assert_eq!(compared(&held), [""; 0]);
    // Welded to a parent that moves itself: the same, but the base is another body.
    let links = ["base", "lower", "fin", "upper"].map(|name| block(name, 0.1, 1.0)).to_vec();
    let mut arm = model(
        links,
        vec![
            joint("a", "base", "lower", TURN).at(Isometry3::translation(1.0, 0.0, 0.0)),
            joint("weld", "lower", "fin", JointKind::Fixed).at(Isometry3::translation(0.0, 1.0, 0.0)),
            joint("b", "lower", "upper", TURN).at(Isometry3::translation(1.0, 0.0, 0.0)),
        ],
    );
    assert_eq!(compared(&arm), ["base upper"]);
    // A pair that is taken back.
    arm.kept_apart = vec![("upper".into(), "fin".into()), ("lower".into(), "fin".into())];
    assert_eq!(compared(&arm), ["base upper", "fin upper"]);
}

/// Frames without shapes between a base and what a joint moves are nothing: the base is the link of the joint.
#[test]
fn a_frame_between_base_and_joint_is_no_link_of_its_own() {
    let links =
        vec![block("base", 0.2, 0.3), Link::new("mount"), Link::new("flange"), block("arm", 0.3, 0.0)];
    let weld = |name: &str, parent: &str, child: &str| joint(name, parent, child, JointKind::Fixed);
    let up = JointKind::Prismatic { low: 0.0, high: 1.0 };
    let mut arm = model(
        links,
        vec![weld("1", "base", "mount"), weld("2", "mount", "flange"), joint("up", "flange", "arm", up)],
    );
    // Free at zero, and together higher up.
    assert_eq!(compared(&arm), [""; 0]);
    let found = arm.sampled_pairs(&Interrupt::never()).unwrap();
    assert_eq!(found.pairs[0].reason, Some(TouchReason::Adjacent));
    // A link with a shape in between is that of the joint.
    arm.links[1] = block("mount", 0.1, 0.6);
    assert_eq!(compared(&arm), ["base arm"]);
}

/// What stands still may be the room: walls welded to the root are compared with what a joint of the root moves, also where they
/// are welded to the link of the joint. What touches it at zero belongs to the joint.
#[test]
fn walls_welded_to_the_root_are_compared() {
    let slide = JointKind::Prismatic { low: 0.0, high: 3.0 };
    let make = |wall: f64| {
        let links = vec![block("base", 0.1, 1.0), block("wall", 0.4, 0.0), block("cart", 0.4, 0.0)];
        let place = Isometry3::translation(wall, 0.0, 0.0);
        let joints = vec![
            joint("weld", "base", "wall", JointKind::Fixed).at(place),
            joint("drive", "base", "cart", slide).axis(Vector3::x()),
        ];
        model(links, joints)
    };
    assert_eq!(compared(&make(2.0)), ["wall cart"]);
    let mut arm = Arm::new(&make(2.0), []).unwrap();
    let at = |arm: &mut Arm, x: f64| arm.clearance(&Configuration::from(vec![x]), 10.0);
    assert_eq!(at(&mut arm, 1.9), 0.0);
    assert!((at(&mut arm, 1.0) - 0.6).abs() < 1e-9);
    let touching = Arm::new(&make(0.3), []).unwrap();
    assert!(touching.checked_pairs().is_empty());
    assert!(touching.not_compared()[0].contains("\"wall\" and \"cart\""), "{:?}", touching.not_compared());
    // An SRDF says which links may touch: nothing else is guessed.
    let given = make(0.3).with_srdf("<robot/>").unwrap();
    assert_eq!(compared(&given), ["wall cart"]);
    // Also of a base that floats.
    let bounds = mp_geom::Aabb::new([-1.0; 3].into(), [1.0; 3].into());
    assert_eq!(compared(&ArmModel { floating: Some(bounds), ..make(2.0) }), ["wall cart"]);
    // And of one that drives.
    assert_eq!(compared(&make(2.0).with_planar_base([-1.0; 2], [1.0; 2]).unwrap()), ["wall cart"]);
}

#[test]
fn an_srdf_switches_links_off_and_takes_pairs_back() {
    let links = ["base", "a", "b", "c", "d"].map(|name| block(name, 0.1, 0.0)).to_vec();
    let at = Isometry3::translation(0.5, 0.0, 0.0);
    let names = ["base", "a", "b", "c", "d"];
    let joints =
        names.windows(2).map(|w| joint(&format!("{}{}", w[0], w[1]), w[0], w[1], TURN).at(at)).collect();
    let model = model(links, joints);
    let with =
        |elements: &str| model.clone().with_srdf(&format!("<robot name=\"r\">{elements}</robot>")).unwrap();
    assert_eq!(compared(&with("")), ["base b", "base c", "a c", "base d", "a d", "b d"]);
    let off = r#"<disable_default_collisions link="d"/>"#;
    assert_eq!(compared(&with(off)), ["base b", "base c", "a c"]);
    let back = format!(
        "{off}<enable_collisions link1=\"a\" link2=\"d\"/><enable_collisions link1=\"b\" link2=\"a\"/>"
    );
    assert_eq!(compared(&with(&back)), ["base b", "a b", "base c", "a c", "a d"]);
    // A pair that is switched off by itself stays so.
    let both = format!("{back}<disable_collisions link1=\"d\" link2=\"a\" reason=\"User\"/>");
    assert_eq!(compared(&with(&both)), ["base b", "a b", "base c", "a c"]);
    // What is skipped is said: links of another robot, and elements that have a meaning.
    let absent = with(
        "<disable_collisions link1=\"foot\" link2=\"base\"/><enable_collisions link1=\"a\" link2=\"hand\"/>\
         <disable_default_collisions link=\"head\"/><passive_joint name=\"ab\"/><sensor name=\"s\"/>\
         <group name=\"g\"/><group_state name=\"home\" group=\"g\"/>",
    );
    assert_eq!(compared(&absent).len(), 6);
    let notes = absent.notes.join("\n");
    for what in ["\"foot\", \"hand\", \"head\"", "passive", "\"ab\"", "\"sensor\""] {
        assert!(notes.contains(what), "{what}: {notes}");
    }
    assert_eq!(absent.notes.len(), 3);
    assert!(model.clone().with_srdf("<robot><disable_default_collisions name=\"d\"/></robot>").is_err());
}

/// Links a hair apart in every configuration: nothing could be certified about them.
#[test]
fn links_that_stay_close_without_touching_are_left_out_and_said() {
    let make = |gap: f64| {
        let links = vec![
            block("base", 0.2, 0.0),
            Link::new("axle"),
            block("cover", 0.18, 0.19 + gap),
            block("tip", 0.1, 0.9),
        ];
        model(
            links,
            vec![
                joint("a", "base", "axle", TURN),
                joint("b", "axle", "cover", TURN),
                joint("c", "axle", "tip", TURN),
            ],
        )
    };
    for gap in [1e-5, 5e-5, 1.5e-4] {
        let arm = Arm::new(&make(gap), []).unwrap();
        assert!(2.0 * arm.tolerance() > gap);
        assert_eq!(arm.checked_pairs(), [["base", "tip"], ["cover", "tip"]], "{gap}");
        let note = &arm.not_compared()[0];
        assert!(note.contains("\"base\" and \"cover\"") && note.contains("apart than"), "{note}");
        let srdf = make(gap).with_srdf("<robot/>").unwrap();
        assert_eq!(compared(&srdf).len(), 2);
        // A pair that must not touch is compared, and named as the closest.
        let mut kept =
            Arm::new(&ArmModel { kept_apart: vec![("base".into(), "cover".into())], ..make(gap) }, [])
                .unwrap();
        let closest = kept.closest(&[0.0, 0.5, 0.0]).unwrap();
        assert_eq!((closest.link.as_str(), closest.other.as_str()), ("base", "cover"));
        assert!((closest.distance - gap).abs() < 1e-9);
    }
    // Farther apart, it is compared; what is in contact everywhere is left out, unless an SRDF says which pairs may touch.
    assert_eq!(compared(&make(1e-3)), ["base cover", "base tip", "cover tip"]);
    assert_eq!(compared(&make(-1e-3)).len(), 2);
    assert_eq!(compared(&make(-1e-3).with_srdf("<robot/>").unwrap()).len(), 3);
}

/// The tolerance is that of the links, however far they slide or stand from the root.
#[test]
fn the_tolerance_does_not_grow_with_what_only_places_the_links() {
    let make = |travel: f64, held: Option<f64>, place: f64| {
        let slide = JointKind::Prismatic { low: -travel, high: travel };
        let links = vec![
            Link::new("world"),
            block("base", 0.4, 0.0),
            block("arm", 0.2, 0.3),
            block("hand", 0.1, 0.3),
        ];
        let mut made = model(
            links,
            vec![
                joint("x", "world", "base", slide)
                    .axis(Vector3::x())
                    .at(Isometry3::translation(place, 0.0, 0.0)),
                joint("turn", "base", "arm", TURN).at(Isometry3::translation(0.0, 0.0, 0.3)),
                joint("reach", "arm", "hand", JointKind::Prismatic { low: 0.0, high: travel })
                    .at(Isometry3::translation(0.0, 0.0, 0.4)),
            ],
        );
        if let Some(held) = held {
            made.joints[0].kind = JointKind::Prismatic { low: held, high: held };
        }
        Arm::new(&made, []).unwrap()
    };
    let usual = make(1.0, None, 0.0);
    assert!((1e-5..2e-4).contains(&usual.tolerance()), "{}", usual.tolerance());
    assert_eq!(usual.tolerance(), make(1000.0, None, 0.0).tolerance());
    assert!(make(1000.0, None, 0.0).reach() > 2000.0);
    for far in [make(1.0, Some(500.0), 0.0), make(1.0, None, 500.0)] {
        assert!(far.tolerance() <= 2.0 * usual.tolerance(), "{}", far.tolerance());
    }
    // A floor, fixed to a base that stands still; one that a joint moves is a link like others.
    let with_floor = |under: &str| {
        let floor = cuboid(1000.0, 1000.0, 1.0).unwrap();
        let floor = Link::new("floor").with(&floor, &Isometry3::translation(0.0, 0.0, -5.0));
        let mut made = usual.model().clone();
        made.links.push(floor);
        made.joints.push(joint("weld", under, "floor", JointKind::Fixed));
        Arm::new(&made, []).unwrap().tolerance()
    };
    assert_eq!(with_floor("world"), usual.tolerance());
    assert!(with_floor("arm") > 0.01);
    // What floating point resolves there.
    assert!((make(1e6, None, 0.0).tolerance() / 2e-3 - 1.0).abs() < 0.01);
    // A free configuration near one that is not is found though joints slide far.
    let mut folded = make(1e5, None, 0.0);
    let space = folded.space().unwrap();
    let free = folded.nearest_free(&Configuration::from(vec![0.0, 0.0, 0.0]), &space, 1e-3);
    assert!(free.is_some());
}

/// A bar of a metre turns all around beside a post, on a foot that overlaps the post's; `flag` is welded to the bar.
fn turnstile() -> ArmModel {
    let all_around = JointKind::Continuous;
    let bar = cuboid(1.0, 0.02, 0.02).unwrap();
    let post = cuboid(0.2, 0.2, 1.0).unwrap();
    let links = vec![
        block("foot", 0.1, -0.5),
        Link::new("post").with(&post, &Isometry3::translation(0.7, 0.0, 0.0)),
        Link::new("bar").with(&bar, &Isometry3::translation(0.5, 0.0, 0.0)),
        Link::new("flag").with(&cuboid(0.1, 0.02, 0.3).unwrap(), &Isometry3::translation(0.3, 0.0, 0.0)),
        block("cap", 0.6, -0.6),
    ];
    let joints = vec![
        joint("weld", "foot", "post", JointKind::Fixed),
        joint("turn", "foot", "bar", all_around),
        joint("weld flag", "bar", "flag", JointKind::Fixed),
        joint("spin", "bar", "cap", TURN),
    ];
    model(links, joints)
}

#[test]
fn pairs_are_sampled_until_they_are_known() {
    let model = turnstile();
    let found = model.sampled_pairs(&Interrupt::never()).unwrap();
    let of = |a: &str, b: &str| found.pairs.iter().find(|pair| pair.links == [a, b]).unwrap();
    assert_eq!(of("foot", "bar").reason, Some(TouchReason::Adjacent));
    assert_eq!(of("foot", "post").reason, Some(TouchReason::Never));
    assert_eq!(of("bar", "flag").reason, Some(TouchReason::Always));
    assert_eq!(of("foot", "cap").reason, Some(TouchReason::Always));
    assert_eq!(of("post", "flag").reason, Some(TouchReason::Never));
    // The bar touches the post where the near corner of the post, 0.6 m away and 0.1 m aside, is less than half its width away:
    // up to atan(0.1 / 0.6) + asin(0.01 / 0.608) to either side. It does at zero, so it is allowed; its share says how rarely.
    let bar = of("post", "bar");
    let share = (mp_math::atan2(0.1, 0.6) + mp_math::asin(0.01 / 0.608_3)) / std::f64::consts::PI;
    assert_eq!(bar.reason, Some(TouchReason::Default));
    assert!((bar.share - share).abs() < 5e-4, "{} is not {share}", bar.share);
    assert_eq!(found, model.sampled_pairs(&Interrupt::never()).unwrap());
    assert_eq!(found.pairs.len(), 10);

    // The file says the same, and what it leaves out is compared.
    let srdf = found.srdf("r & d", false);
    assert!(srdf.contains("<robot name=\"r &amp; d\">"), "{srdf}");
    let line =
        "<disable_collisions link1=\"post\" link2=\"bar\" reason=\"Default\"/> <!-- in 5.8% of them -->";
    assert!(srdf.contains(line) && !srdf.contains("Never"), "{srdf}");
    assert_eq!(
        compared(&model.clone().with_srdf(&srdf).unwrap()),
        ["foot flag", "post flag", "post cap", "flag cap"]
    );
    assert_eq!(compared(&model.clone().with_srdf(&found.srdf("r", true)).unwrap()), [""; 0]);
}

/// Which links must not touch does not depend on what is held or on limits of a problem: links are compared that only a held joint connects, and
/// links that are held in their place are compared with obstacles, by the checker and by the verifier.
#[test]
fn what_is_held_is_compared_all_the_same() {
    let links = vec![
        block("base", 0.1, -1.0),
        block("a", 0.3, 0.0),
        block("b", 0.3, 1.0),
        block("c", 0.3, 0.4),
        block("d", 0.1, 5.0),
    ];
    let step = JointKind::Prismatic { low: -0.3, high: 1.0 };
    let joints = vec![
        joint("1", "base", "a", step).axis(Vector3::x()),
        joint("2", "a", "b", TURN),
        joint("3", "b", "c", step).axis(Vector3::z()),
        joint("4", "c", "d", TURN),
    ];
    let free = model(links, joints);
    let pairs = compared(&free);
    assert!(pairs.contains(&"a c".to_owned()), "{pairs:?}");
    let [held, two] = [("3", "3"), ("3", "2")].map(|(a, b)| {
        free.clone()
            .holding(a, -0.3)
            .and_then(|held| held.holding(b, if b == "2" { 0.0 } else { -0.3 }))
            .unwrap()
    });
    let narrow = free.clone().with_limits("3", -0.3, -0.29).unwrap();
    for model in [&held, &two, &narrow] {
        let mut found = compared(model);
        found.sort();
        let mut all = pairs.clone();
        all.sort();
        assert_eq!(found, all);
    }
    // Also where the joint was described without room, and where one mimics it that could not if it were free.
    let mut roomless = free.clone();
    roomless.joints[2].kind = JointKind::Prismatic { low: 0.0, high: 0.0 };
    assert!(compared(&roomless.with_limits("3", -0.3, 1.0).unwrap()).contains(&"a c".to_owned()));
    // Limits that are equal in the description: one body with what carries it, unless an SRDF says what may touch; obstacles count.
    let mut equal = free.clone();
    equal.joints[0].kind = JointKind::Prismatic { low: 0.0, high: 0.0 };
    equal.joints[2].kind = JointKind::Prismatic { low: -0.3, high: -0.3 };
    assert!(!compared(&equal).contains(&"a c".to_owned()));
    assert!(compared(&equal.clone().with_srdf("<robot/>").unwrap()).contains(&"a c".to_owned()));
    let post = (String::from("post"), cuboid(0.1, 0.1, 0.1).unwrap(), Isometry3::translation(0.1, 0.1, 0.0));
    let contacts = Arm::new(&equal, [post]).unwrap().explain(&[0.5, 0.0]);
    assert_eq!((&*contacts[0].link, &*contacts[0].other), ("a", "post"));
    // Limits that are wider than described.
    let wide = narrow.clone();
    let wide = ArmModel {
        joints: wide.joints.into_iter().map(|joint| Joint { described: None, ..joint }).collect(),
        ..wide
    };
    assert!(!compared(&wide).contains(&"a c".to_owned()));
    assert!(compared(&wide.with_limits("3", -0.3, 1.0).unwrap()).contains(&"a c".to_owned()));
    let mut turning = free.clone();
    turning.joints[3] = joint("4", "c", "d", TURN).mimic("5", 1.0, 0.0);
    turning.links.push(block("e", 0.1, 9.0));
    turning.joints.push(joint("5", "base", "e", JointKind::Continuous));
    let held = turning.holding("5", 0.5).and_then(|held| held.holding("3", 0.4)).unwrap();
    assert!(compared(&held).contains(&"a c".to_owned()));
    let held = free.clone().holding("3", -0.3).unwrap();
    // `c` is in `a` there.
    let mut arm = Arm::new(&held, []).unwrap();
    let q = |numbers: &[f64]| Configuration::from(numbers);
    assert!(!arm.is_valid(&q(&[0.0, 0.0, 0.0])));
    let mut arm = Arm::new(&two, []).unwrap();
    assert!(!arm.is_valid(&q(&[0.0, 0.0])) && arm.explain(&[0.0, 0.0])[0].other == "c");
    let space = arm.space().unwrap();
    let mut verifier = ArmVerifier::new(&space, &arm).unwrap();
    assert!(!verifier.check_motion(&q(&[0.0, 0.0]), &q(&[0.5, 0.5])).is_free());
    // All but the last link stand still, in an obstacle or beside it.
    let still =
        [("1", 0.5), ("2", 0.0), ("3", 0.9)].into_iter().try_fold(free, |m, (j, at)| m.holding(j, at));
    for (x, is_free) in [(0.8, false), (0.95, true)] {
        let post =
            (String::from("post"), cuboid(0.5, 0.2, 0.2).unwrap(), Isometry3::translation(x, 0.0, 0.0));
        let mut arm = Arm::new(still.as_ref().unwrap(), [post]).unwrap();
        let space = arm.space().unwrap();
        let (from, to) = (q(&[0.0]), q(&[0.1]));
        assert_eq!(arm.is_valid(&from), is_free, "{x}");
        assert_eq!(arm.explain(&[0.0]).is_empty(), is_free, "{x}");
        assert_eq!(
            ArmVerifier::new(&space, &arm).unwrap().check_motion(&from, &to).is_free(),
            is_free,
            "{x}"
        );
        let clearance = arm.clearance(&from, 10.0);
        assert!((clearance - (x - 0.9_f64).max(0.0)).abs() < 1e-9, "{clearance}");
    }
}
