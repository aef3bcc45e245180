#!/usr/bin/python3
"""Full disks and folders that nobody may write to, for every kind of file that the program writes: exit code 4, a
sentence with the file's name and the system's reason, an older file as it was, no temporary file; and a cache that
cannot be kept is no failure at all.

Runs in a mount namespace of its own, where it mounts a small disk in memory and a folder for reading only. Exit code 77
(skipped) where the system allows no namespaces, or where no other user may run the program.

Usage: faults_disk.py PROGRAM SOURCE
"""
import os
import pathlib
import shutil
import subprocess
import sys

import faults

INSIDE = "SCUMBLE_FAULTS_DISK_INSIDE"


def enter_namespace():
    if os.environ.get(INSIDE):
        return
    for options in ("-m", "-rm"):
        if subprocess.run(["unshare", options, "true"], stderr=subprocess.DEVNULL).returncode == 0:
            os.environ[INSIDE] = "1"
            os.execvp("unshare", ["unshare", options, sys.executable, *sys.argv])
    print("the system allows no mount namespaces")
    raise SystemExit(77)


def mount(*arguments):
    if subprocess.run(["mount", *map(str, arguments)]).returncode != 0:
        print("the system allows no mounts")
        raise SystemExit(77)


def fill(disk):
    """Leaves no room for a byte; names of empty files still have some."""
    filler = os.open(disk / "filler", os.O_WRONLY | os.O_CREAT)
    try:
        while True:
            os.write(filler, b"x" * 4096)
    except OSError:
        os.close(filler)


def outputs(folder, scene, guides):
    """What writes each kind of file into the folder: (a file that it cannot write, arguments)."""
    transfer = ["transfer", guides, "--style", "style"]
    kinds = {f"p{ending}": [*transfer, "-o", folder / f"p{ending}"] for ending in (".png", ".exr", ".tif", ".jpg")}
    kinds["g.exr"] = ["guidegen", scene, "--size", 64, "-o", folder / "g.exr"]
    kinds["s.png"] = ["stylize", scene, "--style", "style", "--size", 64, "-o", folder / "s.png"]
    kinds["f.2.png"] = [*transfer, "--frames", "2-4", "-o", folder / "f.#.png"]
    kinds["map.png"] = ["compare", guides, "other.exr", "-o", folder / "map.png"]
    kinds["template.png"] = ["sphere", "--size", 64, "--only", "png", "-o", folder]
    kinds["template.ora"] = ["sphere", "--size", 64, "--only", "ora", "-o", folder]
    kinds["template.pdf"] = ["sphere", "--size", 128, "--only", "pdf", "-o", folder]
    if shutil.which("blender"):
        kinds["report.html"] = ["crosscheck", scene, "--size", 32, "--samples", 1, "-o", folder / "report.html"]
        kinds["limits.json"] = ["crosscheck", scene, "--size", 160, "--write-baseline", folder / "limits.json"]
    return kinds


def refuses(program, failures, folder, scene, reason, **more):
    """Every kind of output is refused there for that reason, and what was there stays."""
    before = faults.contents(folder)
    for name, arguments in outputs(folder, scene, "g.exr").items():
        code, said = program.run(*arguments, **more)
        error = faults.error_in(said)
        where = f"{name}, {reason}: exit code {code}: {said.strip()[-300:]}"
        failures.check(code == 4 and name in error and reason in error, where)
        failures.check(faults.contents(folder) == before, f"{where}: left {sorted(os.listdir(folder))}")
    print(f"{reason}: {len(outputs(folder, scene, 'g.exr'))} kinds of outputs", flush=True)


def standard_output(program, failures):
    for arguments in (["--help"], ["info", "g.exr", "--json"], ["compare", "g.exr", "g.exr"], ["styles"]):
        with open("/dev/full", "w") as full:
            code, said = program.run(*arguments, stdout=full)
        failures.check(code == 4 and "standard output" in faults.error_in(said), f"{arguments} > /dev/full: {code}: {said}")


def caches(program, failures, disk, read_only):
    """A cache that keeps nothing changes nothing."""
    run = ["transfer", "g.exr", "--style", "style", "--set", "transfer.nearest=table", "-o", "c.png"]
    code, said = program.run(*run)
    failures.check(code == 0, said)
    whole = (program.folder / "c.png").read_bytes()
    tables = list((program.folder / "cache" / "scumble").glob("*.table"))
    failures.check(len(tables) == 1, f"the style has its table in the cache: {tables}")
    (program.folder / "a file").write_text("no folder")
    for cache in (disk / "cache", read_only, read_only / "new", program.folder / "a file", pathlib.Path("/proc/none")):
        code, said = program.run(*run, env=dict(program.environment, XDG_CACHE_HOME=str(cache)))
        failures.check(code == 0 and (program.folder / "c.png").read_bytes() == whole, f"cache {cache}: {code}: {said}")
    table = tables[0].read_bytes()
    flipped = bytearray(table)
    flipped[len(table) // 2] ^= 1
    for damaged in (b"", table[:8], table[:-1], table + b"x", bytes(len(table)), bytes(flipped)):
        tables[0].write_bytes(damaged)
        code, said = program.run(*run)
        failures.check(code == 0 and (program.folder / "c.png").read_bytes() == whole, f"a damaged table: {code}: {said}")
        failures.check(tables[0].read_bytes() == table, "a damaged table is made again")
    tables[0].unlink()
    tables[0].mkdir()
    code, said = program.run(*run)
    failures.check(code == 0 and (program.folder / "c.png").read_bytes() == whole, f"a folder for a table: {code}: {said}")


def permissions(program, failures, scene):
    """As a user whom the folder does not belong to; root may write anywhere. False: there is no such user to be had."""
    closed = program.folder / "closed"
    closed.mkdir()
    (closed / "p.png").write_text("an older one")
    closed.chmod(0o555)
    user = []
    if os.geteuid() == 0:
        user = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
        if subprocess.run([*user, "true"], stderr=subprocess.DEVNULL).returncode != 0:
            print("no other user to be had: permissions are not tested")
            return False
        program.folder.chmod(0o755)
    plain = program.path
    wrapper = program.folder / "as_user"
    wrapper.write_text("#!/bin/sh\nexec " + " ".join(user) + f" '{plain}' \"$@\"\n")
    wrapper.chmod(0o755)
    program.path = str(wrapper)
    may_run = program.run("--version")[0] == 0
    if not may_run:
        print("another user may not run the program where it is: permissions are not tested")
    else:
        refuses(program, failures, closed, scene, "Permission denied",
                env=dict(program.environment, XDG_CACHE_HOME=str(closed)))
        secret = program.folder / "secret.exr"
        shutil.copy(program.folder / "g.exr", secret)
        secret.chmod(0)
        code, said = program.run("info", secret)
        failures.check(code == 3 and "Permission denied" in faults.error_in(said), f"unreadable guides: {code}: {said}")
    program.path = plain
    return may_run


def main():
    enter_namespace()
    path, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    failures = faults.Failures()
    with faults.temporary_folder() as name:
        program = faults.Program(path, name)
        faults.write_style(program.folder / "style")
        scene = source / "scenes" / "ball.glb"
        for output, size in (("g.exr", 64), ("other.exr", 64)):
            more = ["--view", "30,10"] if output == "other.exr" else []
            code, said = program.run("guidegen", scene, "--size", size, *more, "-o", output)
            failures.check(code == 0, said)
        disk, read_only = program.folder / "disk", program.folder / "read_only"
        disk.mkdir()
        mount("-t", "tmpfs", "-o", "size=64k", "none", disk)  # in a namespace: gone with the last who is in it
        for older in ("p.png", "g.exr", "f.2.png"):
            (disk / older).write_text("an older one")
        fill(disk)
        refuses(program, failures, disk, scene, "No space left on device")
        read_only.mkdir()
        (read_only / "p.png").write_text("an older one")
        mount("--bind", read_only, read_only)
        mount("-o", "remount,bind,ro", read_only)
        refuses(program, failures, read_only, scene, "Read-only file system")
        caches(program, failures, disk, read_only)
        standard_output(program, failures)
        all_tried = permissions(program, failures, scene)
        for mounted in (disk, read_only):
            subprocess.run(["umount", str(mounted)])
    if not failures.lines and not all_tried:
        raise SystemExit(77)  # skipped: what could be tried is right
    failures.end()


if __name__ == "__main__":
    main()
