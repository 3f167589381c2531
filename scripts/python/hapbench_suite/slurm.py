"""A suite's shards as a job array of Slurm, and a job that finishes the submission when all are done."""
import os
import re
import shlex
import subprocess

from hapbench_command import write

from .suite import SuiteError

USUAL = re.compile(r"[\w\-:.,]*", re.ASCII)  # of --time and --partition, as for a sweep


def submit(words, folder, shards, options):
    """Writes suite.sbatch and finish.sbatch into `folder` and submits them; what it says is returned. `words`: the command without --shard."""
    for value in (options.time, options.partition):
        if not USUAL.fullmatch(value):
            raise SuiteError(f'--time, --partition: got "{value}"; allowed: letters, digits and _-:.,')
    if not str(folder.resolve()).isprintable():
        raise SuiteError("--out: got a path with a control character; allowed with --slurm: paths without")
    line = f"cd {shlex.quote(os.getcwd())} && exec {shlex.join(map(str, words))} --jobs {options.cpus} --quiet"
    # What is there is not computed again, so a task that was preempted or killed goes on where it was.
    array = script(options, folder, "suite", "%a", [f"--array=0-{shards - 1}", "--requeue"], f'{line} --shard "$SLURM_ARRAY_TASK_ID/{shards}"')
    last = script(options, folder, "finish", "finish", ["--kill-on-invalid-dep=yes"], line)
    files = folder / "suite.sbatch", folder / "finish.sbatch"
    for file, text in zip(files, (array, last)):
        write(file, text)
    if options.dry_run:
        return "\n".join([*(f"# {file}\n{file.read_text(encoding='utf-8')}" for file in files), "# nothing is submitted (--dry-run)"])
    jobs = [job := sbatch(files[0]), sbatch(f"--dependency=afterok:{job}", files[1])]
    return f"{shards} shards submitted as job {jobs[0]}, their end as job {jobs[1]}\n{folder}"


def script(options, folder, name, log, more, line):
    fields = [f"--job-name=hapbench-{name}", f"--cpus-per-task={options.cpus}", f'--output="{folder.resolve() / f"slurm_{log}.log"}"', "--open-mode=append", *more]
    fields += [f"--{field}={value}" for field, value in (("partition", options.partition), ("time", options.time)) if value]
    return "\n".join(["#!/bin/bash", '# Written by "hapbench suite run --slurm".', *(f"#SBATCH {one}" for one in fields), line, ""])


def sbatch(*words):
    """Number of the new job."""
    try:
        done = subprocess.run(["sbatch", "--parsable", *map(str, words)], capture_output=True, text=True, encoding="utf-8", check=False)
    except FileNotFoundError:
        raise SuiteError("--slurm: got no sbatch here; allowed: where Slurm is, or with --dry-run") from None
    number = (done.stdout.split() or [""])[-1].split(";")[0]
    if done.returncode or not number.isdigit():
        raise SuiteError(f"--slurm: sbatch says: {(done.stderr or done.stdout).strip()}; allowed: what it accepts")
    return number
