//! Robots with macros: files of xacro, expanded by the crate `xacro-rs`.

#[cfg(feature = "xacro")]
mod otherwise;

use mp_formats::error::{Error, ErrorKind};
use std::path::Path;

/// Larger files are refused.
#[cfg(feature = "xacro")]
const MAX_BYTES: u64 = 16 << 20;

/// The URDF for which the macros in the file at `path` stand; `arguments` are `NAME:=VALUE`. The file and those that it includes are read from
/// the disk. `$(find PACKAGE)` looks for packages of ROS by the environment, and above the file.
///
/// # Errors
/// [`Error`] when an argument is not of this form, a macro makes no sense, or a file is missing; and always without the feature `xacro`.
pub fn expand_xacro(path: &Path, arguments: &[String]) -> Result<String, Error> {
    let mut pairs = Vec::new();
    for argument in arguments {
        let pair = argument.split_once(":=").filter(|(name, _)| !name.is_empty());
        pairs.push(pair.ok_or_else(|| {
            Error::new(
                ErrorKind::Format,
                "--arg",
                format!("`{}` is no argument", mp_formats::text::clipped(argument)),
            )
            .help("write NAME:=VALUE")
        })?);
    }
    expanded(path, &pairs)
}

#[cfg(feature = "xacro")]
fn expanded(path: &Path, arguments: &[(&str, &str)]) -> Result<String, Error> {
    use std::path::PathBuf;
    use xacro_rs::XacroProcessor;
    use xacro_rs::extensions::{FindExtension, OptEnvExtension};
    let builder = XacroProcessor::builder()
        .with_extension(Box::new(FindExtension::new()))
        .with_extension(Box::new(OptEnvExtension::new()))
        .with_ros_yaml_units()
        .with_compat_all();
    let builder = arguments.iter().fold(builder, |builder, (name, value)| builder.with_arg(*name, *value));
    let (made, included) = builder.build().run_with_deps(path).map_err(|e| {
        let message = format!("the macros cannot be expanded: {}", mp_formats::error::one_line(&e.to_string(), 250));
        Error::new(ErrorKind::Content, path.display(), message)
            .help("give arguments by --arg NAME:=VALUE, or expand it by the program of ROS: `xacro FILE > robot.urdf`")
    })?;
    let mut definitions = otherwise::Definitions::default();
    // An argument may be used where none is declared.
    let mut unused: Vec<&str> = arguments.iter().map(|(name, _)| *name).collect();
    let refused = |file: &Path, what: &str| {
        Error::new(
            ErrorKind::Unsupported,
            file.display(),
            format!("{what} would mean something else here than for ROS"),
        )
        .help("expand it by the program of ROS: `xacro FILE > robot.urdf`")
    };
    for file in std::iter::once(path).chain(included.iter().map(PathBuf::as_path)) {
        let bytes = mp_store::read(file, MAX_BYTES)?;
        let text = mp_formats::xml::text(&file.display().to_string(), &bytes)?;
        if let Some(what) = definitions.add(&text) {
            return Err(refused(file, &what));
        }
        unused.retain(|name| !["$(arg ", "arg('"].iter().any(|used| text.contains(&format!("{used}{name}"))));
    }
    if let Some(name) = unused.iter().find(|name| !definitions.arguments.contains(**name)) {
        let known: Vec<&str> = definitions.arguments.iter().map(String::as_str).collect();
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        let message = format!("{} has no argument `{}`", path.display(), mp_formats::text::clipped(name));
        return Err(Error::new(ErrorKind::Content, "--arg", message).help(format!("there are: {known}")));
    }
    definitions.hidden().map_or(Ok(made), |what| Err(refused(path, &what)))
}

#[cfg(not(feature = "xacro"))]
fn expanded(path: &Path, _: &[(&str, &str)]) -> Result<String, Error> {
    Err(Error::new(ErrorKind::Unsupported, path.display(), "this is a robot description with macros").help(
        "expand it first: `xacro FILE > robot.urdf`; or install this program so that it does: `cargo install --path crates/mp-cli --features xacro`",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:arg name='side' default='1'/>\
                        <xacro:macro name='bar' params='name'><link name='${name}'><collision><geometry><box size='$(arg side) 1 1'/>\
                        </geometry></collision></link></xacro:macro><xacro:bar name='one'/></robot>";

    #[test]
    fn macros_are_expanded_or_said_to_be_there() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("r.urdf.xacro");
        std::fs::write(&file, TEXT).unwrap();
        let made = expand_xacro(&file, &["side:=2.5".to_owned()]);
        match cfg!(feature = "xacro") {
            true => {
                let made = made.unwrap();
                assert!(
                    made.contains("2.5 1 1") && made.contains("one") && !made.contains("macro"),
                    "{made}"
                );
                std::fs::write(&file, TEXT.replace("xacro:bar", "xacro:rod")).unwrap();
                assert!(expand_xacro(&file, &[]).unwrap_err().to_string().contains("cannot be expanded"));
            }
            false => {
                assert!(made.unwrap_err().remedy().is_some_and(|help| help.contains("--features xacro")))
            }
        }
        assert_eq!(expand_xacro(&file, &["side".to_owned()]).unwrap_err().file(), "--arg");
        if cfg!(feature = "xacro") {
            std::fs::write(&file, TEXT).unwrap();
            let error = expand_xacro(&file, &["syde:=2".to_owned()]).unwrap_err();
            assert!(
                error.to_string().contains("no argument `syde`") && error.remedy() == Some("there are: side"),
                "{error}"
            );
        }
    }

    /// What the program of ROS (xacro 2.1.1) computes otherwise than the crate: never a wrong number.
    #[cfg(feature = "xacro")]
    #[test]
    fn what_would_mean_something_else_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let said = |inside: &str| {
            let file = folder.path().join("r.xacro");
            let before = "<xacro:property name='y' value='2'/><xacro:property name='z' value='${y*10}'/><xacro:arg name='q' default='-2'/>";
            let text = format!(
                "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>{before}{inside}</robot>"
            );
            std::fs::write(&file, text).unwrap();
            expand_xacro(&file, &[])
        };
        for (inside, what) in [
            // ROS: -4, -4, 2, -3, and the lower power first.
            ("<a v='${-y**2}'/>", "a minus before `**`"),
            ("<a v='${3*-(y)**2}'/>", "a minus before `**`"),
            ("<a v='${-sin(y)**2}'/>", "a minus before `**`"),
            ("<a v='${$(arg q)**2}'/>", "`**`"),
            ("<a v='${-7 % 3}'/>", "`%`"),
            ("<a v='${int(-3.9)}'/>", "`int`"),
            ("<xacro:property name='w' value='${y}' lazy_eval='false'/>", "the property `w`"),
            ("<xacro:property name='y' remove='true'/>", "the property `y`"),
            // ROS: 20, the `y` of where `z` is defined.
            (
                "<xacro:macro name='m' params='y'><a v='${z}'/></xacro:macro><xacro:m y='5'/>",
                "the property `z`, which depends on `y`",
            ),
            (
                "<xacro:macro name='n' params=''><a v='${z}'/></xacro:macro><xacro:macro name='m' params='y'><xacro:n/></xacro:macro><xacro:m y='5'/>",
                "within the macro `m`",
            ),
            (
                "<xacro:macro name='m' params='y b:=${y}'><a v='${b}'/></xacro:macro><xacro:m y='5'/>",
                "`y` in a default",
            ),
        ] {
            let error = said(inside).expect_err(inside);
            assert!(error.to_string().contains(what) && error.remedy().is_some(), "{inside}: {error}");
        }
        for (inside, number) in [
            ("<a v='${(-y)**2}'/>", "\"4\""),
            ("<a v='${3-y**2}'/>", "\"-1\""),
            ("<a v='${2**-y}'/>", "\"0.25\""),
            ("<a v='${&apos;5 % -y**2&apos;}'/>", "5 % -y**2"),
            ("<a v='5 %'/>", "\"5 %\""),
            (
                "<xacro:macro name='m' params='y'><xacro:property name='z' value='${y*3}'/><a v='${z}'/></xacro:macro><xacro:m y='5'/>",
                "\"15\"",
            ),
            ("<xacro:macro name='m' params='k'><a v='${z*k}'/></xacro:macro><xacro:m k='5'/>", "\"100\""),
        ] {
            let made = said(inside).expect(inside);
            assert!(made.contains(number), "{inside}: {made}");
        }
        // In a file that is included too.
        std::fs::write(
            folder.path().join("i.xacro"),
            "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><a v='${-2**2}'/></robot>",
        )
        .unwrap();
        assert!(said("<xacro:include filename='i.xacro'/>").unwrap_err().file().ends_with("i.xacro"));
    }
}
