use super::*;
use mp_formats::files::InMemory;
use std::sync::Mutex;

/// Files in memory, and what is said of them.
#[derive(Debug)]
struct Heard<'a> {
    more: &'a str,
    said: Mutex<Vec<String>>,
}

impl Files for Heard<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
        InMemory(|name: &str| (name == "models/more.xml").then_some(self.more)).read(path, limit)
    }
    fn note(&self, _: &Path, remark: &str) {
        self.said.lock().unwrap().push(remark.to_owned());
    }
}

fn read_all(text: &str, more: &str) -> (Result<Mjcf, Error>, Vec<String>) {
    let files = Heard { more, said: Mutex::default() };
    let read = read(&files, Path::new("models/arm.xml"), text.to_owned());
    (read, files.said.into_inner().unwrap())
}

fn of(text: &str) -> Mjcf {
    let (read, _) = read_all(text, "");
    read.unwrap_or_else(|e| panic!("{}", e.report()))
}

const ARM: &str = r#"<mujoco model="arm">
  <compiler meshdir="meshes"/>
  <include file="more.xml"/>
  <default>
    <default class="arm">
      <joint axis="0 1 0" range="-90 90"/>
      <default class="seen"><geom type="mesh" contype="0" conaffinity="0"/></default>
    </default>
  </default>
  <asset><mesh file="hand.stl" scale="2 2 2" refpos="0 0 0.5"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <geom type="box" size="1 1 .1" pos="0 0 -1"/>
    <body name="base" pos="0 0 1" childclass="arm">
      <geom type="cylinder" size=".1 .2"/>
      <geom class="seen" mesh="gone"/>
      <body name="upper" axisangle="0 0 1 90">
        <joint name="lift" pos="0 0 .5" ref="90"/>
        <joint name="slide" type="slide" axis="0 0 1" range="0 2"/>
        <geom type="capsule" size=".05" fromto="0 0 0 0 0 1"/>
        <frame pos="0 0 1" euler="90 0 0">
          <body name="hand">
            <joint type="ball" range="0 45"/>
            <geom type="mesh" mesh="hand"/>
            <geom type="ellipsoid" size=".1 .2 .3"/>
          </body>
        </frame>
      </body>
    </body>
    <body name="ball" pos="2 0 0"><freejoint/><geom size=".1" contype="2" conaffinity="2"/></body>
  </worldbody>
  <contact><exclude body1="base" body2="hand"/></contact>
  <equality><joint joint1="finger" joint2="slide" polycoef="0.1 -0.5"/></equality>
  <tendon><spatial name="wire"/></tendon>
  <keyframe><key name="home" qpos="1.5 0.25 0.7071067811865476 0.7071067811865476 0 0 2 0 0 1 0 0 0 0.3"/></keyframe>
</mujoco>"#;

const MORE: &str = "<mujocoinclude>\n<worldbody/>\n</mujocoinclude>";

/// A finger, which ends the world.
fn arm() -> String {
    let finger = "<body name=\"finger\">\n<joint name=\"finger\" type=\"slide\"/><geom size=\"0.01\"/></body>\n</worldbody>";
    ARM.replace("</worldbody>", finger)
}

#[test]
fn a_model_as_urdf_and_srdf() {
    let (read, said) = read_all(&arm(), MORE);
    let read = read.unwrap();
    insta::assert_snapshot!([read.urdf.as_str(), &read.srdf, &said.join("\n")].join("\n"));
    assert_eq!(read.made.keys().collect::<Vec<_>>(), ["mjcf://ellipsoid"]);
    // Errors are where the model has what is wrong.
    let line = 1 + read.urdf.lines().position(|line| line.contains("name=\"slide\"")).unwrap();
    let shown = read.origin.error(Some(line), "no".to_owned()).to_string();
    assert!(shown.starts_with("models/arm.xml:19:9: no"), "{shown}");
    let included =
        arm().replace("<worldbody>", "<worldbody><body name='first'><include file='more.xml'/></body>");
    let included = included.replacen("  <include file=\"more.xml\"/>\n", "", 1);
    let (read, _) = read_all(&included, "<mujocoinclude>\n\n <joint name='j'/>\n</mujocoinclude>");
    let read = read.unwrap();
    let line = 1 + read.urdf.lines().position(|line| line.contains("name=\"j\"")).unwrap();
    assert!(read.origin.error(Some(line), String::new()).to_string().starts_with("models/more.xml:3:2:"));
}

/// In files of other folders, names are relative to the model, or else to the file that says them, as MuJoCo has it.
#[test]
fn names_in_included_files_may_be_relative_to_these() {
    let body = "<worldbody><body name='x'><joint/><geom type='mesh' mesh='d'/><include file='b.xml'/></body></worldbody>";
    let part = format!("<mujoco><asset><mesh file='d.stl'/></asset>{body}</mujoco>");
    let read_with = |compiler: &str, there: &[&str]| {
        let files = InMemory(|name: &str| match name {
            "models/sub/a.xml" => Some(part.clone()),
            "models/sub/b.xml" => Some("<mujoco><geom size='0.5'/></mujoco>".to_owned()),
            name => there.contains(&name).then(String::new),
        });
        let text = format!("<mujoco>{compiler}<include file='sub/a.xml'/></mujoco>");
        let urdf =
            read(&files, Path::new("models/arm.xml"), text).unwrap_or_else(|e| panic!("{}", e.report())).urdf;
        assert!(urdf.contains("sphere radius=\"0.5\""), "{urdf}");
        urdf.split("filename=\"").nth(1).unwrap().split('"').next().unwrap().to_owned()
    };
    let (meshes, [plain, sub]) = ("<compiler meshdir='m'/>", ["models/d.stl", "models/sub/d.stl"]);
    assert_eq!(read_with("", &[sub]), "sub/d.stl");
    assert_eq!(read_with("", &[plain, sub]), "d.stl");
    assert_eq!(read_with(meshes, &["models/m/sub/d.stl", sub]), "m/sub/d.stl");
    assert_eq!(read_with(meshes, &["models/m/d.stl", "models/m/sub/d.stl"]), "m/d.stl");
    // Where there is none, the error is about the first.
    assert_eq!(read_with(meshes, &[]), "m/d.stl");
}

#[test]
fn turns_mean_the_same_however_they_are_given() {
    // A quarter turn about z.
    for turn in
        ["quat='1 0 0 1'", "axisangle='0 0 2 90'", "xyaxes='0 3 0 -1 7 0'", "euler='0 0 90'", "class='q'"]
    {
        let text = format!(
            "<mujoco><default><default class='q'><geom quat='1 0 0 1'/></default></default><worldbody><body><joint/>\
             <geom size='1' {turn}/></body></worldbody></mujoco>"
        );
        let urdf = of(&text).urdf;
        assert!(urdf.contains("rpy=\"0 0 1.57079632679489"), "{turn}: {urdf}");
    }
    // Of a class that has one an element takes no other.
    let text = "<mujoco><default><geom quat='1 0 0 1'/></default><worldbody><body><joint/><geom size='1' euler='0 0 45'/></body>\
                </worldbody></mujoco>";
    assert!(of(text).urdf.contains("rpy=\"0 0 0.785398163397448"));
    let upward = "<mujoco><compiler eulerseq='ZYX' angle='radian'/><worldbody><body><joint/><geom size='1' euler='0.1 0.2 0.3'/></body>\
                  </worldbody></mujoco>";
    // Capital letters turn about the axes that stand still: as roll, pitch and yaw in the opposite order.
    let turn = nalgebra::UnitQuaternion::from_euler_angles(0.3, 0.0, 0.0)
        * nalgebra::UnitQuaternion::from_euler_angles(0.0, 0.2, 0.0)
        * nalgebra::UnitQuaternion::from_euler_angles(0.0, 0.0, 0.1);
    let (roll, pitch, yaw) = turn.euler_angles();
    let urdf = of(upward).urdf;
    let rpy = urdf.split("rpy=\"").nth(1).unwrap().split('"').next().unwrap();
    let read: Vec<f64> = rpy.split(' ').map(|x| x.parse().unwrap()).collect();
    let off = read.iter().zip([roll, pitch, yaw]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-14, "{rpy}, {roll} {pitch} {yaw}");
}

/// As MuJoCo 4.0.0 has it: a class takes over what is said before it; a later section changes the class of the whole model, and those that come after.
#[test]
fn classes_take_over_what_was_said_before() {
    let body =
        "<worldbody><body name='b'><joint/><geom class='a'/><geom class='c'/><geom/></body></worldbody>";
    let text = format!(
        "<mujoco><default><geom size='1'/><default class='a'><geom type='sphere'/></default></default>\
         <default><geom size='2'/><default class='c'/></default><default><geom size='3'/></default>{body}</mujoco>"
    );
    let urdf = of(&text).urdf;
    let radii: Vec<_> = urdf.split("radius=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert_eq!(radii, ["1", "2", "3"]);
    // An include between them may say that nothing of the whole model collides; what has a class does.
    let text = text.replace("<geom size='3'/>", "<geom contype='0' conaffinity='0'/>");
    assert_eq!(of(&text).urdf.matches("<collision>").count(), 2);
}

/// As MuJoCo 4.0.0 has it.
#[test]
fn what_is_not_said_is_that_of_the_class() {
    let size = |classes: &str, geom: &str| {
        let text = format!(
            "<mujoco><default>{classes}</default><worldbody><body><joint/><geom {geom}/></body></worldbody></mujoco>"
        );
        let urdf = of(&text).urdf;
        urdf.split("<geometry>").nth(1).unwrap().split("/>").next().unwrap().to_owned()
    };
    let outer = "<geom size='.5 .25 .125'/><default class='i'><geom size='1 2'/></default>";
    assert_eq!(size(outer, "type='box' size='4'"), "<box size=\"8 0.5 0.25\"");
    assert_eq!(size(outer, "class='i' type='box' size='4'"), "<box size=\"8 4 0.25\"");
    assert_eq!(size(outer, "type='capsule' size='1'"), "<capsule radius=\"1\" length=\"0.5\"");
    // Equalities of joints have the class of all equalities, and not that of joints.
    let follows = |said: &str, equality: &str| {
        let text = format!(
            "<mujoco><default>{said}</default><worldbody><body><joint name='a' range='-9 9'/><geom size='1'/><body><joint name='b' range='-9 9'/>\
             <geom size='1'/></body></body></worldbody><equality>{equality}</equality></mujoco>"
        );
        let urdf = of(&text).urdf;
        urdf.split("<mimic joint=\"a\" ").nth(1).map(|rest| rest.split("/>").next().unwrap().to_owned())
    };
    let plain = "<joint joint1='b' joint2='a'/>";
    let one = |offset: &str| Some(format!("multiplier=\"1\" offset=\"{offset}\""));
    assert_eq!(follows("", plain), one("0"));
    assert_eq!(follows("<equality active='false'/>", plain), None);
    assert_eq!(
        follows("<equality active='false'/>", "<joint joint1='b' joint2='a' active='true'/>"),
        one("0")
    );
    assert_eq!(follows("", "<joint joint1='b' joint2='a' polycoef='0.5'/>"), one("0.5"));
    // Folders of meshes: of one element that of meshes counts, of several what was said last.
    let folder = |compiler: &str| {
        let text = format!(
            "<mujoco>{compiler}<asset><mesh file='m.stl'/></asset><worldbody><body><joint/><geom type='mesh' mesh='m'/></body></worldbody></mujoco>"
        );
        of(&text).urdf.split("filename=\"").nth(1).unwrap().split('"').next().unwrap().to_owned()
    };
    assert_eq!(folder("<compiler meshdir='m' assetdir='a'/>"), "m/m.stl");
    assert_eq!(folder("<compiler meshdir='m'/><compiler assetdir='a'/>"), "a/m.stl");
    assert_eq!(folder("<compiler assetdir='a'/><compiler meshdir='m'/>"), "m/m.stl");
}

#[test]
fn bits_and_bodies_say_what_may_touch() {
    let text = "<mujoco><worldbody><geom name='w' size='1'/><body name='a'><geom size='1'/>\
                <body name='b'><joint/><joint axis='1 0 0'/><geom size='1'/>\
                <body name='c'><joint/><geom size='1'/><body name='d'><joint/><geom name='d' size='1' conaffinity='0' contype='4'/></body></body></body></body>\
                </worldbody><contact>PAIR</contact></mujoco>";
    let pairs_of = |text: &str, pair: &str| {
        let srdf = of(&text.replace("PAIR", pair)).srdf;
        let pairs = srdf.lines().filter(|line| line.contains("collisions"));
        pairs
            .map(|line| {
                line.split('"')
                    .step_by(2)
                    .zip(line.split('"').skip(1).step_by(2))
                    .take(2)
                    .map(|(_, v)| v)
                    .collect::<String>()
            })
            .collect::<Vec<_>>()
    };
    let pairs = |pair: &str| pairs_of(text, pair);
    // b hangs on a by two joints, but a stands still, as the world does; d touches nothing by its bits.
    assert_eq!(pairs(""), ["bc", "worldd", "ad", "bd", "cd", "worldb"]);
    assert_eq!(
        pairs("<pair geom1='w' geom2='d'/><exclude body1='world' body2='c'/>"),
        ["worldc", "bc", "ad", "bd", "cd", "worldb", "worldd"]
    );
    // Where a moves freely it is a parent like any other, although it stands here too.
    let free = text.replace("<body name='a'>", "<body name='a'><freejoint/>");
    assert_eq!(pairs_of(&free, ""), ["ab", "bc", "worldd", "ad", "bd", "cd", "worldb"]);
    // Where parents are not left out: b and c are kept apart.
    let strict = text.replace("<worldbody>", "<option><flag filterparent='disable'/></option><worldbody>");
    let srdf = of(&strict.replace("PAIR", "")).srdf;
    assert!(srdf.contains("<enable_collisions link1=\"b\" link2=\"c\""), "{srdf}");
}

#[test]
fn errors_say_the_element_and_the_line() {
    let body =
        |inside: &str| format!("<mujoco>\n<worldbody><body name='b'>\n{inside}</body></worldbody></mujoco>");
    for (text, place, words) in [
        ("<mujoco><body>".to_owned(), ":1", "MJCF, an XML file"),
        ("<mujoco model='m'/>".to_owned(), ":1:1", "no <worldbody>"),
        (body("<joint type='screw'/>"), ":3:1", "hinge, slide, ball or free"),
        (body("<joint axis='0 0 0'/>"), ":3:1", "has a direction"),
        (body("<joint range='2 1'/>"), ":3:1", "the lower one first"),
        (body("<joint limited='true'/>"), ":3:1", "as the joint is limited"),
        (body("<joint pos='1 2'/>"), ":3:1", "3 numbers"),
        (body("<joint pos='1 2 inf'/>"), ":3:1", "numbers, with blanks"),
        (body("<geom type='box' size='1 1'/>"), ":3:1", "3 numbers above 0"),
        (body("<geom type='mesh' mesh='m'/>"), ":3:1", "there is no mesh \"m\""),
        (body("<geom type='cone' size='1'/>"), ":3:1", "box, sphere"),
        (body("<geom size='1' class='none'/>"), ":3:1", "no default class \"none\""),
        (body("<geom size='1' quat='0 0 0 0'/>"), ":3:1", "not all of them 0"),
        (body("<replicate count='3'/>"), ":3:1", "mj_saveLastXML"),
        (body("<body name='b'/>"), ":3:1", "two bodies named \"b\""),
        (body("<joint name='j'/><body><joint name='j'/></body>"), ":3:24", "two joints named \"j\""),
        (body("<include file='gone.xml'/>"), ":3:1", "no such file"),
        (body("<include file='more.xml'/><include file='more.xml'/>"), ":3:27", "a second time"),
        (body("<include/>"), ":3:1", "no file"),
        ("<mujoco>\n<compiler coordinate='global'/></mujoco>".to_owned(), ":2:1", "MuJoCo 2.3"),
        ("<mujoco>\n<compiler eulerseq='xy'/></mujoco>".to_owned(), ":2:1", "three letters"),
        (
            "<mujoco><worldbody/>\n<contact><exclude body1='world' body2='x'/></contact></mujoco>".to_owned(),
            ":2:10",
            "no body \"x\"",
        ),
        (
            format!(
                "<mujoco><worldbody>{}{}</worldbody></mujoco>",
                "<body>".repeat(300),
                "</body>".repeat(300)
            ),
            ":1",
            "200 deep",
        ),
    ] {
        let e = read_all(&text, "<mujocoinclude/>").0.expect_err(&text);
        let shown = e.to_string() + e.remedy().unwrap_or_else(|| panic!("{text}: no remedy"));
        assert!(shown.contains(&format!("arm.xml{place}")) && shown.contains(words), "{text}: {shown}");
        crate::fuzz::check_error(&e);
    }
}

#[test]
fn models_are_told_by_their_first_element() {
    for (text, is) in [
        ("<mujoco/>", true),
        ("<?xml version='1.0'?>\n<!-- <robot> --> <mujoco\nmodel='x'>", true),
        ("<mujocoinclude>", true),
        ("<mujocos/>", false),
        ("<robot/>", false),
        ("<!-- <mujoco> -->", false),
    ] {
        assert_eq!(is_mjcf(text), is, "{text}");
    }
}
