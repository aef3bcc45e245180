#!/usr/bin/python3
"""Full disks and read-only folders, for every kind of file that the program writes: exit code 4, a sentence with the
file's name and the system's reason, an older file as it was, no temporary file; and a cache that cannot be kept is no
failure at all.

Runs in a mount namespace of its own, where it mounts a small disk in memory and a folder for reading only. Exit code 77
(skipped) where the system allows no namespaces, or where no other user may run the program.

Usage: disk.py PROGRAM SOURCE
"""
import os
import pathlib
import shutil
import subprocess
import sys

import common

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


def fill(disk, pages=0):
    """Leaves room for so many pages of 4096 bytes, or for no byte; names of empty files still have some."""
    filler = os.open(disk / "filler", os.O_WRONLY | os.O_CREAT)
    try:
        while True:
            os.write(filler, b"x" * 4096)
    except OSError:
        os.ftruncate(filler, os.fstat(filler).st_size - 4096 * pages)
        os.close(filler)


def older_files(folder):
    """The files that a run would replace there."""
    (folder / "trade" / "pictures").mkdir(parents=True)
    for older in ("p.png", "g.exr", "f.2.png", *(f"trade/{name}" for name in common.REPORT)):
        (folder / older).write_text("an older one")


def tradeoff(scene, folder):
    return ["tradeoff", scene, "--style", "style", "--size", 32, "--only", "levels 1", "--repeat", 1, "--no-memory",
            "-o", folder]


def outputs(folder, scene, guides):
    """The command for each kind of file in the folder: (a file that it cannot write, arguments)."""
    transfer = ["transfer", guides, "--style", "style"]
    kinds = {f"p{ending}": [*transfer, "-o", folder / f"p{ending}"] for ending in (".png", ".exr", ".tif", ".jpg")}
    kinds["g.exr"] = ["guidegen", scene, "--size", 64, "-o", folder / "g.exr"]
    kinds["s.png"] = ["stylize", scene, "--style", "style", "--size", 64, "-o", folder / "s.png"]
    kinds["f.2.png"] = [*transfer, "--frames", "2-4", "-o", folder / "f.#.png"]
    kinds["map.png"] = ["compare", guides, "other.exr", "-o", folder / "map.png"]
    kinds["template.png"] = ["sphere", "--size", 64, "--only", "png", "-o", folder]
    kinds["template.ora"] = ["sphere", "--size", 64, "--only", "ora", "-o", folder]
    kinds["template.pdf"] = ["sphere", "--size", 128, "--only", "pdf", "-o", folder]
    kinds["lit.png"] = ["sphere", "--rectify", "kit/template.png", "--size", 64, "-o", folder / "lit.png"]
    kinds["trade/report.html"] = tradeoff(scene, folder / "trade")
    if shutil.which("blender"):
        kinds["report.html"] = ["crosscheck", scene, "--size", 32, "--samples", 1, "-o", folder / "report.html"]
        kinds["limits.json"] = ["crosscheck", scene, "--size", 160, "--write-baseline", folder / "limits.json"]
    return kinds


def refuses(program, failures, folder, scene, reason, **more):
    """Every kind of output is refused there for that reason, and existing files stay."""
    before = common.contents(folder)
    for name, arguments in outputs(folder, scene, "g.exr").items():
        code, said = program.run(*arguments, **more)
        error = common.error_in(said)
        where = f"{name}, {reason}: exit code {code}: {said.strip()[-300:]}"
        failures.check(code == 4 and name in error and reason in error, where)
        failures.check(common.contents(folder) == before, f"{where}: left {sorted(os.listdir(folder))}")
    print(f"{reason}: {len(outputs(folder, scene, 'g.exr'))} kinds of outputs", flush=True)


def standard_output(program, failures):
    for arguments in (["--help"], ["info", "g.exr", "--json"], ["compare", "g.exr", "g.exr"], ["styles"]):
        with open("/dev/full", "w") as full:
            code, said = program.run(*arguments, stdout=full)
        failures.check(code == 4 and "standard output" in common.error_in(said),
                       f"{arguments} > /dev/full: {code}: {said}")


def report_without_room(program, failures, disk, scene):
    """Where there is room for pictures and not for their page, an older report stays whole."""
    before = common.contents(disk, ignored=("filler",))
    fill(disk, pages=3)
    code, said = program.run(*tradeoff(scene, disk / "trade"))
    error = common.error_in(said)
    failures.check(code == 4 and "report.html: No space left on device" in error, f"tradeoff: {code}: {said}")
    failures.check(common.contents(disk, ignored=("filler",)) == before, "a part of an older report is gone")
    fill(disk)


def caches(program, failures, disk, read_only):
    """A cache that keeps nothing has no effect on the result: neither one of tables nor one of the times of
    --budget-ms, where an hour is enough for the unchanged style at any times."""
    run = ["transfer", "g.exr", "--style", "style", "-o", "c.png"]
    kept = program.folder / "cache" / "scumble"
    one_cache(program, failures, disk, read_only, [*run, "--set", "transfer.nearest=table"], kept, True)
    one_cache(program, failures, disk, read_only, [*run, "--budget-ms", 3600000], kept / "times", False)


def one_cache(program, failures, disk, read_only, run, folder, is_same):
    """is_same: files made again have the same bytes, unlike times."""
    code, said = program.run(*run)
    failures.check(code == 0, said)
    whole = (program.folder / "c.png").read_bytes()
    kept = list(folder.glob("*.table"))
    failures.check(len(kept) == 1, f"one file is in the cache {folder}: {kept}")
    (program.folder / "a file").write_text("no folder")
    for cache in (disk / "cache", read_only, read_only / "new", program.folder / "a file", pathlib.Path("/proc/none")):
        code, said = program.run(*run, env=dict(program.environment, XDG_CACHE_HOME=str(cache)))
        failures.check(code == 0 and (program.folder / "c.png").read_bytes() == whole, f"cache {cache}: {code}: {said}")
    table = kept[0].read_bytes()
    flipped = bytearray(table)
    flipped[len(table) // 2] ^= 1
    for damaged in (b"", table[:8], table[:-1], table + b"x", bytes(len(table)), bytes(flipped)):
        kept[0].write_bytes(damaged)
        code, said = program.run(*run)
        failures.check(code == 0 and (program.folder / "c.png").read_bytes() == whole,
                       f"damaged {kept[0]}: {code}: {said}")
        made = kept[0].read_bytes()
        failures.check(made == table if is_same else made != damaged, f"damaged, {kept[0]} is made again")
    kept[0].unlink()
    kept[0].mkdir()
    code, said = program.run(*run)
    failures.check(code == 0 and (program.folder / "c.png").read_bytes() == whole,
                   f"a folder for {kept[0]}: {code}: {said}")


def permissions(program, failures, scene):
    """As a user whom the folder does not belong to; root may write anywhere. False: there is no such user to be had."""
    closed = program.folder / "closed"
    older_files(closed)
    for folder in (closed / "trade" / "pictures", closed / "trade", closed):
        folder.chmod(0o555)
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
        failures.check(code == 3 and "Permission denied" in common.error_in(said), f"unreadable guides: {code}: {said}")
    program.path = plain
    return may_run


def main():
    enter_namespace()
    path, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    failures = common.Failures()
    with common.temporary_folder() as name:
        program = common.Program(path, name)
        common.write_style(program.folder / "style")
        scene = source / "scenes" / "ball.glb"
        for output, size in (("g.exr", 64), ("other.exr", 64)):
            more = ["--view", "30,10"] if output == "other.exr" else []
            code, said = program.run("guidegen", scene, "--size", size, *more, "-o", output)
            failures.check(code == 0, said)
        code, said = program.run("sphere", "--size", 512, "--only", "png", "-o", "kit")
        failures.check(code == 0, said)
        for kind in (["sphere", "--rectify", "kit/template.png", "--size", 64, "-o", "lit.png"],
                     tradeoff(scene, "trade")):
            code, said = program.run(*kind)  # where there is room
            failures.check(code == 0, said)
        failures.check(set(common.REPORT) <= set(common.contents(program.folder / "trade")), "a report's files")
        disk, read_only = program.folder / "disk", program.folder / "read_only"
        disk.mkdir()
        mount("-t", "tmpfs", "-o", "size=64k", "none", disk)  # in a namespace: unmounted when its last process ends
        older_files(disk)
        fill(disk)
        refuses(program, failures, disk, scene, "No space left on device")
        report_without_room(program, failures, disk, scene)
        older_files(read_only)
        mount("--bind", read_only, read_only)
        mount("-o", "remount,bind,ro", read_only)
        refuses(program, failures, read_only, scene, "Read-only file system")
        caches(program, failures, disk, read_only)
        standard_output(program, failures)
        all_tried = permissions(program, failures, scene)
        for mounted in (disk, read_only):
            subprocess.run(["umount", str(mounted)])
    if not failures.lines and not all_tried:
        raise SystemExit(77)  # skipped: all possible checks passed
    failures.end()


if __name__ == "__main__":
    main()
