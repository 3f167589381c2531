"""Writing files, each complete or not at all."""
import os

from hapbench_report.json_input import InputError


def write(file, data):
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        scratch = file.with_name(f".{file.name}.{os.getpid()}.tmp")
        try:
            scratch.write_bytes(data)
            scratch.replace(file)
        finally:
            scratch.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"--out {file}: {error.strerror}") from error
