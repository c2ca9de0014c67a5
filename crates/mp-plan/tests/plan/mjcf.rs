//! Robots as models of MuJoCo.

use mp_geom::TriMesh;
use mp_io::{Disk, InMemory, ProblemChanges, RobotProblem};
use mp_plan::info::Info;
use mp_plan::{Request, RobotPairs, Scene};
use mp_robot::{ArmModel, Kinematics};
use std::path::Path;

/// Joints aside of the origin of their body, with a reference, several of a body, all kinds of turns.
const TWO: &str = r#"<mujoco model="two">
  <compiler eulerseq="zyx"/>
  <worldbody>
    <body name="base" pos="0.1 0 0.5" euler="90 0 0">
      <geom type="box" size=".05 .05 .05"/>
      <body name="upper" pos="0.2 0 0" quat="1 0 1 0">
        <joint name="swing" axis="0 1 1" pos="0 0 .1" ref="30" range="-120 120"/>
        <joint name="slide" type="slide" axis="1 0 0" range="-.5 .5"/>
        <geom type="capsule" size=".03" fromto="0 0 .15 0 0 .5"/>
        <body name="hand" pos="0 0 .6" xyaxes="0 1 0 -1 0 0">
          <joint name="wrist" type="ball"/>
          <geom type="ellipsoid" size=".03 .04 .05"/>
        </body>
      </body>
    </body>
  </worldbody>
  <keyframe><key name="home" qpos="0.3 0.1 1 0 0 0"/></keyframe>
</mujoco>"#;

fn problem(model: &str) -> RobotProblem {
    let files = InMemory(|name: &str| match name {
        "p.toml" => Some("[robot]\nmjcf = \"two.xml\"\n[motion]\nstart = \"home\"\ngoal = []\n"),
        _ => (name == "two.xml").then_some(model),
    });
    RobotProblem::load_from(&files, Path::new("p.toml")).unwrap()
}

/// The poses of bodies are those that MuJoCo 4.0.0 has in `xpos` and `xmat` after `mj_kinematics`.
#[test]
fn bodies_are_where_mujoco_has_them() {
    let robot = &problem(TWO).robots[0];
    let mesh = |name: &str| -> Result<TriMesh, String> { robot.mesh_from(&Disk, name) };
    let kinematics = Kinematics::new(&ArmModel::from_urdf(&robot.urdf, mesh).unwrap()).unwrap();
    let names: Vec<_> = kinematics.coordinates().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["swing", "slide", "wrist/x", "wrist/y", "wrist/z"]);
    let poses = kinematics.link_poses(&[0.7, -0.2, 0.3, -0.4, 0.5]).unwrap();
    let upper = [
        [0.125_593_640_749_106_62, 0.225_593_640_749_106_54, 0.709_305_182_105_538_5],
        [-0.124_088_605_668_849_86, -0.992_240_803_846_633_8, -0.007_759_196_153_365_788],
        [-0.124_088_605_668_849_83, 0.007_759_196_153_366_343, 0.992_240_803_846_633_8],
        [-0.984_481_607_693_267_9, 0.124_088_605_668_849_83, -0.124_088_605_668_849_86],
    ];
    let hand = [
        [0.120_938_123_057_087_15, 0.820_938_123_057_086_9, 0.634_852_018_704_228_6],
        [-0.761_365_753_257_589_5, 0.548_406_019_968_109_8, 0.345_793_329_937_462_9],
        [0.515_104_384_725_961_1, 0.187_810_686_268_741_26, 0.836_298_163_910_068_6],
        [0.393_687_264_973_850_87, 0.814_848_441_973_107, -0.425_478_970_116_511_65],
    ];
    for (link, [place, rows @ ..]) in [("upper", upper), ("hand", hand)] {
        let pose = poses[kinematics.links().position(|name| name == link).unwrap()];
        let turn = pose.rotation.to_rotation_matrix();
        for k in 0..3 {
            let off = (0..3).map(|i| (turn[(k, i)] - rows[k][i]).abs()).fold(0.0, f64::max);
            // A few roundings of numbers about 1.
            assert!(off < 2e-15 && (pose.translation.vector[k] - place[k]).abs() < 2e-15, "{link}: {pose}");
        }
    }
}

/// Frames around joints turn and move their axes. The pose is that of MuJoCo 4.0.0.
#[test]
fn joints_in_frames_are_where_mujoco_has_them() {
    let model = r#"<mujoco>
  <worldbody>
    <body name="arm" pos="0.1 0 0.5">
      <frame pos="0.1 0.2 0" euler="0 30 90">
        <joint name="swing" axis="0 1 1" pos="0 0 .1" ref="30"/>
        <frame axisangle="1 0 0 40"><joint name="slide" type="slide" axis="1 0 0" range="-.5 .5"/></frame>
      </frame>
      <geom size=".05"/>
    </body>
  </worldbody>
  <keyframe><key name="home" qpos="0.7 -0.2"/></keyframe>
</mujoco>"#;
    let robot = &problem(model).robots[0];
    let mesh = |name: &str| -> Result<TriMesh, String> { robot.mesh_from(&Disk, name) };
    let kinematics = Kinematics::new(&ArmModel::from_urdf(&robot.urdf, mesh).unwrap()).unwrap();
    let poses = kinematics.link_poses(&[0.7, -0.2]).unwrap();
    let pose = poses[kinematics.links().position(|name| name == "arm").unwrap()];
    let place = [0.170_311_086_684_892_64, -0.223_152_322_410_576_06, 0.518_839_798_896_171_6];
    let rows = [
        [0.985_521_142_864_872_6, -0.169_508_187_663_838_63, -0.003_879_598_076_683_035_5],
        [0.169_508_187_663_838_63, 0.984_481_607_693_268, 0.045_419_581_994_988_766],
        [-0.003_879_598_076_683_035_5, -0.045_419_581_994_988_766, 0.998_960_464_828_395_5],
    ];
    let turn = pose.rotation.to_rotation_matrix();
    for k in 0..3 {
        let off = (0..3).map(|i| (turn[(k, i)] - rows[k][i]).abs()).fold(0.0, f64::max);
        // A few roundings of numbers about 1.
        assert!(off < 2e-15 && (pose.translation.vector[k] - place[k]).abs() < 2e-15, "{pose}");
    }
}

#[test]
fn a_model_is_planned_for_from_its_keyframe() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("two.xml");
    std::fs::write(&file, TWO).unwrap();
    let changes = ProblemChanges { from: Some("home".to_owned()), ..Default::default() };
    let scene = Scene::load_changed(&Disk, &file, &changes).unwrap();
    assert_eq!(scene.start(), [0.3, 0.1, 0.0, 0.0, 0.0]);
    let report = scene.plan(&Request::new(scene.default_planner())).unwrap();
    assert!(report.verified, "{report:?}");
    let shown = Info::read(&file).unwrap().to_string();
    assert!(shown.contains("three hinges") && shown.contains("wrist/z"), "{shown}");
    // An SRDF beside it is taken instead.
    let pairs = RobotPairs::sampled(&file, &mp_cspace::Interrupt::never()).unwrap();
    assert_eq!(pairs.robot, "two");
    std::fs::write(folder.path().join("two.srdf"), pairs.srdf(false)).unwrap();
    let notes = Scene::load(&file).unwrap().notes().join("\n");
    assert!(notes.contains("two.srdf was found"), "{notes}");
}

/// A base that moves takes the robot along, and not the walls of its model, which would be free of themselves.
#[test]
fn what_stands_in_the_world_does_not_move_with_the_base() {
    let load = |base: &str, world: &str, free: &str| {
        let model = format!(
            "<mujoco><worldbody>{world}<body name='trunk' pos='0 0 1'>{free}<geom size='.1'/><body name='leg'><joint axis='0 1 0'/>\
             <geom type='capsule' size='.02' fromto='0 0 0 0 0 .5'/></body></body></worldbody></mujoco>"
        );
        let bounds = if base == "planar" { "[[-1, -1], [1, 1]]" } else { "[[-1, -1, -1], [1, 1, 1]]" };
        let problem = format!(
            "[robot]\nmjcf = \"m.xml\"\nbase = \"{base}\"\nbounds = {bounds}\n[motion]\nstart = []\ngoal = []\n"
        );
        let at = move |name: &str| match name {
            "p.toml" => Some(problem.clone()),
            _ => (name == "m.xml").then(|| model.clone()),
        };
        RobotProblem::load_from(&InMemory(at), Path::new("p.toml"))
    };
    let (wall, table) =
        ("<geom type='box' size='1 .1 1'/>", "<body name='table'><geom type='box' size='1 1 .1'/></body>");
    let ball = "<body name='ball' pos='0 1 0'><freejoint/><geom size='.1'/></body>";
    for base in ["planar", "floating"] {
        for (world, free, named) in [
            ("", "", None),
            ("", "<freejoint/>", None),
            ("<geom type='plane' size='1 1 1'/>", "<freejoint/>", None),
            (wall, "", Some("\"world\"")),
            (wall, "<freejoint/>", Some("\"world\"")),
            // Without a body that moves freely it may be what the robot stands on.
            (table, "", None),
            (table, "<freejoint/>", Some("\"table\"")),
            (ball, "<freejoint/>", Some("\"ball\"")),
        ] {
            let read = load(base, world, free);
            assert_eq!(read.is_err(), named.is_some(), "{world} {free}");
            if let (Err(e), Some(named)) = (read, named) {
                let help = e.remedy().is_some_and(|help| help.contains("obstacles"));
                assert!(e.line() == Some(3) && help && e.to_string().contains(named), "{e}");
            }
        }
    }
}

/// What is found wrong later is said of the model, and so is what to do about links that touch.
#[test]
fn errors_are_about_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("two.xml");
    let error = |from: &str, to: &str| {
        assert!(TWO.contains(from));
        std::fs::write(&file, TWO.replace(from, to)).unwrap();
        Scene::load(&file).unwrap_err()
    };
    let e = error("<geom type=\"box\" size=\".05 .05 .05\"/>", "<geom type=\"mesh\" mesh=\"m\"/>");
    assert!(e.to_string().contains("two.xml:5:7") && e.to_string().contains("no mesh \"m\""), "{e}");
    let mesh = "<compiler eulerseq=\"zyx\"/><asset><mesh name=\"m\" file=\"gone.stl\"/></asset>";
    let with_mesh = TWO.replace("<compiler eulerseq=\"zyx\"/>", mesh);
    std::fs::write(&file, with_mesh.replace("type=\"box\" size=\".05 .05 .05\"", "type=\"mesh\" mesh=\"m\""))
        .unwrap();
    let e = Scene::load(&file).unwrap_err();
    assert!(e.to_string().contains("two.xml:5:7") && e.to_string().contains("gone.stl"), "{e}");
    let e = error(".03 .04 .05", "2 2 2");
    let help = e.remedy().unwrap_or_default();
    assert!(help.contains("<exclude>") && help.contains("mp srdf"), "{help}");
}
