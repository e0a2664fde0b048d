#!/usr/bin/env python3
"""Packs archives of the program for Linux and Windows and of the page, and tries each as a stranger would: unpacked, and where nothing
else is.

    tests/install/archives.py [--only NAME]... [--no-build] [--out target/archives]

The names are gnu, musl, windows and page. Each program is built with the profile dist. In a Linux or Windows archive are the program,
README, licences, completions and pages for man; an archive is the same to the byte if what it holds is. `--no-build` packs what
is built. The tries are those of tests/install/run.py (a chroot, as root), tests/wine/run.py and tests/browser/run.

    rustup target add x86_64-unknown-linux-musl x86_64-pc-windows-gnu wasm32-unknown-unknown
    apt install musl-tools gcc-mingw-w64-x86-64 wine64 chromium
"""

import argparse
import gzip
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", TOP / "target"))
TARGETS = {"gnu": "x86_64-unknown-linux-gnu", "musl": "x86_64-unknown-linux-musl", "windows": "x86_64-pc-windows-gnu"}
VERSION = tomllib.loads((TOP / "Cargo.toml").read_text())["workspace"]["package"]["version"]


def call(*command):
    subprocess.run([str(word) for word in command], cwd=TOP, check=True)


def build(name):
    if name == "page":
        call("src/web/build", BUILT / "web")
    else:
        call("cargo", "build", "--locked", "--profile", "dist", "--target", TARGETS[name])


def program(name):
    return BUILT / TARGETS[name] / "dist" / ("stickslip.exe" if name == "windows" else "stickslip")


def fill(name, folder):
    """Puts into the folder what the archive holds."""
    if name == "page":
        shutil.copytree(BUILT / "web", folder, dirs_exist_ok=True)
    else:
        shutil.copy(program(name), folder)
        # The program for Windows does not run here, and its completions and pages are the same.
        here = program("gnu" if name == "windows" else name)
        (folder / "completions").mkdir()
        call(here, "man", "-o", folder / "man1")
        for shell, file in [("bash", "stickslip.bash"), ("fish", "stickslip.fish"), ("zsh", "_stickslip"), ("powershell", "stickslip.ps1")]:
            call(here, "completions", shell, "-o", folder / "completions" / file)
        shutil.copy(TOP / "README.md", folder)
    for licence in TOP.glob("LICENSE-*"):
        shutil.copy(licence, folder)


def pack(folder, name, out):
    """An archive of the folder that depends on nothing but the names, contents and permissions of its files."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    if name == "windows":
        archive = out / f"{folder.name}.zip"
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as packed:
            for path in files:
                packed.writestr(zipfile.ZipInfo(str(path.relative_to(folder.parent))), path.read_bytes(), zipfile.ZIP_DEFLATED, 9)
        return archive
    archive = out / f"{folder.name}.tar.gz"
    with open(archive, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, 0) as zipped, tarfile.open(fileobj=zipped, mode="w") as packed:
        for path in files:
            entry = tarfile.TarInfo(str(path.relative_to(folder.parent)))
            entry.size, entry.mode = path.stat().st_size, 0o755 if os.access(path, os.X_OK) else 0o644
            with open(path, "rb") as content:
                packed.addfile(entry, content)
    return archive


def attempt(name, folder):
    """Runs the test of this kind of archive on what was unpacked."""
    if name == "windows":
        call(sys.executable, "tests/wine/run.py", "--program", folder / "stickslip.exe", "--native", program("gnu"))
    elif name == "page":
        call("tests/browser/run", "--page", folder, "--program", program("gnu"), "--out", BUILT / "browser")
    else:
        call(sys.executable, "tests/install/run.py", "--program", folder / "stickslip")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", action="append", choices=[*TARGETS, "page"])
    parser.add_argument("--no-build", action="store_true")
    parser.add_argument("--out", type=Path, default=BUILT / "archives")
    options = parser.parse_args()
    names = options.only or [*TARGETS, "page"]
    # The others are compared with it, and take completions and pages from it.
    needed = names if set(names) <= {"gnu", "musl"} or "gnu" in names else ["gnu", *names]
    if not options.no_build:
        for name in needed:
            build(name)
    options.out.mkdir(parents=True, exist_ok=True)
    for name in names:
        with tempfile.TemporaryDirectory(prefix="stickslip-") as place:
            folder = Path(place) / f"stickslip-{VERSION}-{TARGETS.get(name, 'page')}"
            folder.mkdir()
            fill(name, folder)
            archive = pack(folder, name, options.out)
            print(f"packed      {archive.name}: {archive.stat().st_size / 1e6:.2f} MB", flush=True)
        with tempfile.TemporaryDirectory(prefix="stickslip-") as place:
            shutil.unpack_archive(archive, place)
            attempt(name, Path(place) / folder.name)
    print("all archives are well")


main()
