"""What the site has beyond the folder docs: pages of other folders, and the viewer's page to try."""

import posixpath
import re
from pathlib import Path

from mkdocs.structure.files import File

ROOT = Path(__file__).parents[2]
# Pages of other folders, by their places in the site.
OUTSIDE = {
    "more/project.md": "README.md",
    "more/python.md": "python/README.md",
    "more/mpi.md": "mpi/README.md",
    "more/scenes.md": "crates/mp-scenes/assets/README.md",
    "more/architecture.md": "ARCHITECTURE.md",
    "more/contributing.md": "CONTRIBUTING.md",
    "more/changes.md": "CHANGELOG.md",
}
PLACES = {path: place for place, path in OUTSIDE.items()}
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)#:]+)(#[^)]*)?\)")
DEMO = """
## Try it

<iframe src="demo.html" sandbox="allow-scripts" width="100%" height="600"></iframe>
"""


def on_files(files, config):
    """Add the pages of other folders."""
    for place, path in OUTSIDE.items():
        files.append(File.generated(config, place, abs_src_path=str(ROOT / path)))
    return files


def on_page_markdown(markdown, page, config, files):
    """Lead links to where things are in the site. What is not in it keeps its text alone."""
    here = page.file.src_uri
    folder = posixpath.dirname(OUTSIDE.get(here, f"docs/{here}"))

    def moved(link):
        mark, text, target, heading = link.groups(default="")
        path = posixpath.normpath(posixpath.join(folder, target))
        if (ROOT / path / "README.md").is_file():
            path += "/README.md"
        place = PLACES.get(path, path.removeprefix("docs/"))
        if place == path:
            return text
        return f"{mark}[{text}]({posixpath.relpath(place, posixpath.dirname(here) or '.')}{heading})"

    demo = DEMO if here == "viewer.md" and (Path(config.site_dir) / "../demo.html").is_file() else ""
    return LINK.sub(moved, markdown) + demo


def on_post_build(config):
    """Put the viewer's page beside the others."""
    demo = Path(config.site_dir) / "../demo.html"
    if demo.is_file():
        (Path(config.site_dir) / "demo.html").write_bytes(demo.read_bytes())
