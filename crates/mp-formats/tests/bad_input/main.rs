//! A table of bad files: what each error says, and where.

mod case;
mod collada;
mod meshes;
mod paths;

use case::{Case, case, check};
use mp_formats::error::Error;
use mp_formats::mesh::read_mesh;
use mp_formats::path::PathFile;
use std::path::Path;

fn mesh(file: &Path) -> Result<(), Error> {
    read_mesh(file).map(drop)
}

fn path(file: &Path) -> Result<(), Error> {
    PathFile::read(file).map(drop)
}

const DAE: &str = "<COLLADA>\n<library_geometries><geometry id=\"g\"><mesh>\n<source id=\"p\"><float_array count=\"9\">0 0 0 1 0 0 0 1 0</float_array></source>\n\
<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\n<p>0 1 2</p></triangles>\n\
</mesh></geometry></library_geometries>\n<library_visual_scenes><visual_scene id=\"s\">\n<node><instance_geometry url=\"#g\"/></node>\n</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";

fn dae(from: &str, to: &str, error: &'static str, help: &'static str) -> Case {
    assert!(DAE.contains(from), "{from}");
    case(mesh, "m.dae", DAE.replacen(from, to, 1), error, help)
}

fn off(content: &str, error: &'static str, help: &'static str) -> Case {
    case(mesh, "m.off", content, error, help)
}

#[test]
fn files_that_cannot_be_read() {
    let dir = tempfile::tempdir().unwrap();
    let shown = |e: Error| e.to_string().replace(&dir.path().display().to_string(), "DIR");
    let file = |name: &str| dir.path().join(name);
    assert_eq!(
        shown(read_mesh(file("gone/none.off")).unwrap_err()),
        "DIR/gone/none.off: cannot read the file: no such file"
    );
    assert_eq!(shown(PathFile::read(dir.path()).unwrap_err()), "DIR: this is a folder, not a file");
    // As large as no mesh may be; nothing of it is on the disk, and nothing of it is read.
    std::fs::File::create(file("huge.off")).unwrap().set_len(1 << 40).unwrap();
    assert_eq!(
        shown(read_mesh(file("huge.off")).unwrap_err()),
        "DIR/huge.off: the file has 1099511627776 bytes, more than the 536870912 this reader accepts"
    );
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(file("loop.off"), file("loop.off")).unwrap();
        assert!(
            shown(read_mesh(file("loop.off")).unwrap_err())
                .starts_with("DIR/loop.off: cannot read the file: ")
        );
        let e = read_mesh("/dev/zero").unwrap_err();
        assert_eq!(e.message(), "this is not a regular file");
    }
}
