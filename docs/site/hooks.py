"""What the site has beyond the folder docs: pages of other folders, the crates, and the viewer's page to try."""

import os
import posixpath
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path

from mkdocs.exceptions import PluginError
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
# The folder that `cargo doc` has made, if the crates are to be in the site.
API = os.environ.get("API")
CRATES = """# The crates

Start with `mp-plan`: a scene in, a verified path out. [The architecture](architecture.md) says how the crates depend on each other.

| crate | what it holds |
|---|---|
"""
WITHOUT_API = """
`docs/site/build --api` puts their documentation here; `cargo doc --open` shows it too.
"""
# Links that rustdoc repeats from documentation of `tracing`; and within a page.
OF_OTHERS = ("dispatcher", "")
# Rustdoc's own pages lead to the first one of the folder.
FIRST_OF_API = '<meta http-equiv="refresh" content="0; url=../more/crates.html">'
DEMO = """
## Try it

<iframe src="demo.html" sandbox="allow-scripts" width="100%" height="600"></iframe>
"""


def on_files(files, config):
    """Add the pages of other folders."""
    for place, path in OUTSIDE.items():
        files.append(File.generated(config, place, abs_src_path=str(ROOT / path)))
    content, pages = crates()
    files.append(File.generated(config, "more/crates.md", content=content))
    for page in pages:
        files.append(File.generated(config, f"api/{page}", abs_src_path=str(Path(API) / page)))
    return files


def crates():
    """The page of the crates, each with the description in its manifest; and their first pages in `API`, to which it links."""
    rows, pages = [], []
    for manifest in sorted([*ROOT.glob("crates/*/Cargo.toml"), ROOT / "python/Cargo.toml"]):
        text = manifest.read_text(encoding="utf-8")
        description = re.search(r'^description = "(.*)"$', text, re.MULTILINE)[1]
        library = re.search(r'^\[lib\]\nname = "(.*)"$', text, re.MULTILINE)
        name = manifest.parent.name
        page = f"{library[1] if library else name.replace('-', '_')}/index.html"
        if API and (Path(API) / page).is_file():
            pages.append(page)
            rows.append(f"| [`{name}`](../api/{page}) | {description} |")
        else:
            rows.append(f"| `{name}` | {description} |")
    return CRATES + "\n".join(rows) + "\n" + ("" if API else WITHOUT_API), pages


class Links(HTMLParser):
    """What a page links to."""

    def __init__(self, text):
        super().__init__()
        self.found = set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag == "a":
            self.found |= {value for name, value in attributes if name == "href" and value}


def dead_links(site):
    """Links of the crates' documentation to files that are not in the site."""
    for page in (site / "api").rglob("*.html"):
        for target in Links(page.read_text(encoding="utf-8")).found:
            path = target.partition("#")[0]
            if path not in OF_OTHERS and ":" not in path and not os.path.exists(page.parent / path):
                yield f"{page.relative_to(site)}: {target}"


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
    """Put the viewer's page and the documentation of the crates beside the others."""
    site = Path(config.site_dir)
    demo = site / "../demo.html"
    if demo.is_file():
        (site / "demo.html").write_bytes(demo.read_bytes())
    if not API:
        return
    shutil.copytree(API, site / "api", ignore=shutil.ignore_patterns(".*"), dirs_exist_ok=True)
    if not (site / "api/index.html").exists():
        (site / "api/index.html").write_text(FIRST_OF_API, encoding="utf-8")
    if dead := list(dead_links(site)):
        raise PluginError("dead links:\n" + "\n".join(dead))
