"""The program of another commit, built beside ours."""
import contextlib
import io
import os
import shutil
import subprocess
import tarfile

from .program import ROOT, BenchError, build, say


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def resolved(name):
    found = git("rev-parse", "--verify", "--quiet", f"{name}^{{commit}}")
    if found.returncode:
        raise BenchError(f"--against {name}: no commit of that name in {ROOT}")
    return found.stdout.decode().strip()


@contextlib.contextmanager
def built(name):
    """Its hapbench_bench, in build/against/COMMIT, which stays for the next time; its sources are there only as long as
    the program runs, which reads the scenarios in them. Files have the commit's date, so that nothing is built twice."""
    commit = resolved(name)
    folder = ROOT / "build" / "against" / commit[:12]
    source = folder / "source"
    archive = git("archive", "--format=tar", commit)
    if archive.returncode:
        raise BenchError(f"--against {name}: {archive.stderr.decode().strip()}")
    shutil.rmtree(source, ignore_errors=True)  # of a run that was killed
    try:
        with tarfile.open(fileobj=io.BytesIO(archive.stdout)) as files:
            files.extractall(source)
        say(f"building {commit[:12]} in {os.path.relpath(folder)} (minutes, the first time)")
        # Its build asks git for a commit: let it not find ours.
        alone = {"GIT_CEILING_DIRECTORIES": str(folder)}
        yield build(source, folder / "build", "bin/hapbench_bench", environment=alone) / "hapbench_bench"
    finally:
        shutil.rmtree(source, ignore_errors=True)
