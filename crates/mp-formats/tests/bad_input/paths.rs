//! Bad paths.

use super::*;

#[test]
fn paths() {
    check(&[
        case(
            path,
            "p.txt",
            "",
            "p.txt:1:1: the file is empty; expected the number of configurations, alone on the first line",
            "an export may have failed: write the file again",
        ),
        case(
            path,
            "p.txt",
            "0\n",
            "p.txt:1:1: a path without configurations; expected at least one configuration",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.txt",
            "-1\n",
            "p.txt:1:1: `-1` is not a count; expected the number of configurations, alone on the first line",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.txt",
            "99999999999999999999\n0 0 0 0 0 0\n",
            "p.txt:1:1: `99999999999999999999` is too large a count; expected the number of configurations, alone on the first line",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.txt",
            "0 0 0 0 0 0\n1 0 0 0 0 0\n",
            "p.txt:1:1: the file does not begin with a count; expected the number of configurations, alone on the first line",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.txt",
            "3\n0 0 0 0 0 0\n1 0 0 0 0 0\n",
            "p.txt:3:12: the file ends too early; expected configuration 3 of 3: x y z α β γ",
            "the file may be cut short: copy or export it again",
        ),
        case(
            path,
            "p.txt",
            "1\n0 0 0 0 0 0\n1 0 0 0 0 0\n",
            "p.txt:3:1: `1 0 0 0 0 0` follows the last configuration; expected the end of the file, as the count is 1",
            "correct the count on the first line, or remove what follows",
        ),
        case(
            path,
            "p.txt",
            "2\n0 0 0 0 0 0\n1 0 0 x 0 0\n",
            "p.txt:3:7: `x` is not a number; expected six numbers: x y z α β γ",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.txt",
            "2\n0 0 0 0 0 0\n1 0 0 0 0\n",
            "p.txt:3:1: configuration 2 of 2 has 5 numbers; expected six numbers: x y z α β γ",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.json",
            "{\"path\": [[0, 0, 0, 0, 0, 0],\n [0, 0, 0]]}",
            "p.json:2:10: invalid length 3; expected {\"path\": [[x, y, z, α, β, γ], …]}",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.json",
            "{\"path\": [[0, 0, 0, 0, 0, 0],",
            "p.json:1:29: this is not JSON: EOF while parsing a value; expected {\"path\": [[x, y, z, α, β, γ], …]}",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.json",
            "{\"path\": [[0, 0, 0, 0, 0, 1e999]]}",
            "p.json:1:31: this is not JSON: number out of range; expected {\"path\": [[x, y, z, α, β, γ], …]}",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.json",
            "{\"path\": [[0, 0, 0, 0, 0, NaN]]}",
            "p.json:1:27: this is not JSON: expected value; expected {\"path\": [[x, y, z, α, β, γ], …]}",
            "the format is described in docs/formats/path.md",
        ),
        case(
            path,
            "p.json",
            "{\"solved\": false}",
            "p.json:1:1: there is no path in this file; expected {\"path\": [[x, y, z, α, β, γ], …]}",
            "a result that is not solved has no path",
        ),
        case(
            path,
            "p.json",
            "{\"path\": []}",
            "p.json:1:1: the path has no configurations; expected {\"path\": [[x, y, z, α, β, γ], …]}",
            "a result that is not solved has no path",
        ),
        case(
            path,
            "p.json",
            "[".repeat(100_000),
            "p.json:1:3: invalid type: sequence; expected {\"path\": [[x, y, z, α, β, γ], …]}",
            "the format is described in docs/formats/path.md",
        ),
    ]);
}
