//! Robots with macros: files of xacro, expanded by the crate `xacro-rs`.

use mp_formats::error::{Error, ErrorKind};
use std::path::Path;

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
    use xacro_rs::XacroProcessor;
    use xacro_rs::extensions::{FindExtension, OptEnvExtension};
    let builder = XacroProcessor::builder()
        .with_extension(Box::new(FindExtension::new()))
        .with_extension(Box::new(OptEnvExtension::new()))
        .with_ros_yaml_units()
        .with_compat_all();
    let builder = arguments.iter().fold(builder, |builder, (name, value)| builder.with_arg(*name, *value));
    builder.build().run(path).map_err(|e| {
        let message = format!("the macros cannot be expanded: {}", mp_formats::error::one_line(&e.to_string(), 250));
        Error::new(ErrorKind::Content, path.display(), message)
            .help("give arguments by --arg NAME:=VALUE, or expand it by the program of ROS: `xacro FILE > robot.urdf`")
    })
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
    }
}
