//! Bad COLLADA.

use super::*;

#[test]
fn collada() {
    check(&[
        case(
            mesh,
            "m.dae",
            "",
            "m.dae:1:1: the document does not have a root node; expected COLLADA, an XML file",
            "the file is cut short or not COLLADA: export it again",
        ),
        case(
            mesh,
            "m.dae",
            "<COLLADA>\n<node",
            "m.dae:1:1: the root node was opened but never closed; expected COLLADA, an XML file",
            "the file is cut short or not COLLADA: export it again",
        ),
        case(
            mesh,
            "m.dae",
            "<gltf/>",
            "m.dae:1:1: the document is <gltf>; expected <COLLADA>",
            "the format is described in docs/formats/meshes.md",
        ),
        case(
            mesh,
            "m.dae",
            "<COLLADA/>",
            "m.dae:1:1: the file does not say which scene it shows; expected <scene><instance_visual_scene url=\"#id\"/></scene>",
            "the format is described in docs/formats/meshes.md",
        ),
        case(
            mesh,
            "m.dae",
            "<!DOCTYPE c [<!ENTITY a \"b\">]>\n<COLLADA/>",
            "m.dae:1:1: XML with DTD detected; expected COLLADA, an XML file",
            "remove the <!DOCTYPE …>: document types and entities are not read",
        ),
        dae(
            "</mesh>",
            "</mash>",
            "m.dae:7:1: expected 'mesh' tag, not 'mash'; expected COLLADA, an XML file",
            "the file is cut short or not COLLADA: export it again",
        ),
        dae(
            "0 1 0</float",
            "0 1 zero</float",
            "m.dae:3:55: `zero` is not a number; expected a number of the array",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "0 1 0</float",
            "0 1</float",
            "m.dae:3:16: the array has 8 numbers; expected 9, as its count says",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "count=\"9\"",
            "count=\"many\"",
            "m.dae:3:16: count=\"many\" is not a count",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "<p>0 1 2",
            "<p>0 1 3",
            "m.dae:6:8: index 3 is out of range; expected an index from 0 to 2",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "<p>0 1 2",
            "<p>0 1",
            "m.dae:6:1: <p> has 2 corners; expected three for each triangle",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "<p>0 1 2",
            "<p>0 1 -2",
            "m.dae:6:8: `-2` is not an index; expected a whole number from 0",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "triangles count=\"1\"",
            "triangles count=\"2\"",
            "m.dae:5:1: <triangles count=\"2\"> has 1; expected as many as it counts",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "semantic=\"POSITION\" ",
            "semantic=\"NORMAL\" ",
            "m.dae:5:1: the triangles have no positions; expected an <input semantic=\"VERTEX\"> whose <vertices> has an <input semantic=\"POSITION\">",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "source=\"#v\"",
            "source=\"#w\"",
            "m.dae:5:22: <input> refers to `#w`, which does not exist",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "url=\"#g\"",
            "url=\"other.dae#g\"",
            "m.dae:9:7: <instance_geometry> refers to another file, `other.dae#g`; expected url=\"#id\"",
            "export everything into one file",
        ),
        dae(
            "url=\"#g\"",
            "url=\"#p\"",
            "m.dae:9:7: this refers to <source>; expected <geometry>",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "<node><instance",
            "<node><translate>1 2</translate><instance",
            "m.dae:9:7: <translate> has 2 numbers; expected 3 numbers in <translate>",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "<node><instance",
            "<node><scale>1 1 inf</scale><instance",
            "m.dae:9:18: `inf` is not a finite number; expected 3 numbers in <scale>",
            "coordinates must be finite: correct the program that wrote the file",
        ),
        dae(
            "<node><instance",
            "<node><skew>1 1 1 1 1 1 1</skew><instance",
            "m.dae:9:7: <skew> is not read",
            "apply the transforms of the nodes before exporting",
        ),
        dae(
            "<node><instance_geometry url=\"#g\"/></node>",
            "",
            "m.dae:8:24: the scene shows no geometry, and the file has some; expected nodes with <instance_geometry>",
            "export the mesh again: what only physics uses is not read",
        ),
        dae(
            "<COLLADA>\n",
            "<COLLADA><asset><unit meter=\"0\"/></asset>\n",
            "m.dae:1:17: meter=\"0\" is not a length; expected a number above 0, the length of the unit in metres",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "<COLLADA>\n",
            "<COLLADA><asset><up_axis>W_UP</up_axis></asset>\n",
            "m.dae:1:17: `W_UP` is not an axis; expected X_UP, Y_UP or Z_UP",
            "the format is described in docs/formats/meshes.md",
        ),
        dae(
            "<mesh>",
            "<extra/></geometry><geometry><mesh>",
            "m.dae:2:21: a geometry without <mesh>; expected <mesh>: polygons",
            "export curves and solids as polygons",
        ),
    ]);
}
