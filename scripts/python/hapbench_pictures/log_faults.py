"""Finds faults of a log of a haptic loop that do not prevent a picture. `hapbench run --replay` rejects most of these
logs. scenarios/renderer/loop_log.cpp and open_renderer.cpp check the same rules."""
import math
import re
from itertools import zip_longest

import numpy as np

from hapbench.columns import is_number
from hapbench.results import at, number_or_none, shown

VERSION = 1
COLUMNS = (
    "call,time_ns,has,hx_m,hy_m,hz_m,qw,qx,qy,qz,vx_m_per_s,vy_m_per_s,vz_m_per_s,wx_rad_per_s,wy_rad_per_s,"
    "wz_rad_per_s,fhand_x_N,fhand_y_N,fhand_z_N,fapplied_x_N,fapplied_y_N,fapplied_z_N,input_reserved,fx_N,fy_N,fz_N,"
    "tx_N_m,ty_N_m,tz_N_m,set_x_m,set_y_m,set_z_m,set_vx_m_per_s,set_vy_m_per_s,set_vz_m_per_s,gain,dt_s,status,"
    "contacts,reason,limited"
).split(",")
WHOLE = (
    "call",
    "time_ns",
    "has",
    "status",
    "contacts",
    "reason",
    "limited",
)  # columns of whole numbers
# Matches a field that is not a finite number, also an empty field, but not an empty line.
NO_NUMBER = re.compile(
    rb"(?m)(?:(?<=,)|^(?!\r?$))(?!-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\r?(?:,|$))[^,\r\n]*"
)
LONGEST_RAMP = 60.0  # [s]
ROUNDING = 1e-3  # allowed deviation of the norm of a quaternion from 1


def log_faults(file, about, names, rows, calls, times):
    """Returns a text for each kind of fault of a log. `about`: object of the first line. `names`: names of the columns.
    `rows`: bytes of the rows. `calls`, `times`: number and time [s] of each call."""
    found = [f"line 1: {text}" for text in header_faults(about)]
    found += column_faults(names) + call_faults(rows, calls, times) + field_faults(names, rows)
    return [f"{file}: {text}; the picture is drawn nevertheless" for text in found]


def header_faults(about):
    """Returns a text for each fault of the first line: version, scenario and mount."""
    mount = about.get("mount")
    if about.get("version") != VERSION:
        yield f"version: got {shown(about.get('version'))}; allowed: {VERSION}"
    if not isinstance(about.get("scenario_hash"), str):
        yield f"scenario_hash: got {shown(about.get('scenario_hash'))}; allowed: a string"
    if not isinstance(about.get("torque"), bool):
        yield f"torque: got {shown(about.get('torque'))}; allowed: true or false"
    if not isinstance(mount, dict):
        yield f"mount: got {shown(mount)}; allowed: an object"
        return
    for pose in ("world_from_device", "handle_from_tip"):
        for key, count in (("position_m", 3), ("orientation_wxyz", 4)):
            value = at(mount, f"/{pose}/{key}")
            numbers = [number_or_none(part) for part in value] if isinstance(value, list) else []
            if len(numbers) != count or None in numbers:
                yield f"mount.{pose}.{key}: got {shown(value)}; allowed: {count} numbers"
            elif count == 4 and not abs(math.hypot(*numbers) - 1.0) <= ROUNDING:
                norm = f"a quaternion of norm {math.hypot(*numbers):.6g}"
                yield f"mount.{pose}.{key}: got {norm}; allowed: a norm of 1"
    scale, ramp = number_or_none(mount.get("scale")), number_or_none(mount.get("ramp_s"))
    if scale is None or not scale > 0.0:
        yield f"mount.scale: got {shown(mount.get('scale'))}; allowed: a number > 0"
    if ramp is None or not 0.0 <= ramp <= LONGEST_RAMP:
        yield f"mount.ramp_s: got {shown(mount.get('ramp_s'))}; allowed: 0 to {LONGEST_RAMP:g} s"
    forces = ("max_force_N", "max_force_rate_N_per_s") if about["mode"] == "impedance" else ()
    for key in (*forces, "stale_s", "engage_force_N"):
        value = mount.get(key, "nothing")
        if value is not None and not (number_or_none(value) or 0.0) > 0.0:
            yield f"mount.{key}: got {shown(value)}; allowed: a number > 0, or null for no limit"


def column_faults(names):
    """Returns a list with a text about the first column that is not the column of a log in its position."""
    for number, (got, allowed) in enumerate(zip_longest(names, COLUMNS), 1):
        if got != allowed:
            return [
                f"line 2: column {number}: got {shown(got) if got else 'no column'}; allowed: {allowed or 'no column'}"
            ]
    return []


def call_faults(rows, calls, times):
    """Returns a list with a text about the first call whose number does not follow the call before it, or else whose
    time is earlier."""
    wrong = np.flatnonzero(calls != np.arange(len(calls)))
    back = np.flatnonzero(np.diff(times) < 0.0) + 1
    if not wrong.size and not back.size:
        return []
    lines = [line for line, text in enumerate(rows.split(b"\n"), 3) if text.strip()]
    if wrong.size:
        row = int(wrong[0])
        fault = f"got call {calls[row]} where call {row} is expected; allowed: every call from 0"
    else:
        row = int(back[0])
        step = times[row - 1] - times[row]
        fault = f"time_ns: got a time {step:.3g} s before the previous call; allowed: later times"
    return [f"line {lines[row]}: {fault}"]


def field_faults(names, rows):
    """Returns a list with a text about the first field that is not a finite number, or not a whole number >= 0 in the
    columns WHOLE."""
    found, count = None, 0
    for match in NO_NUMBER.finditer(rows.rstrip()):
        line = rows.count(b"\n", 0, match.start()) if found is None else 0
        column = rows.count(b",", rows.rfind(b"\n", 0, match.start()) + 1, match.start())
        found = found or (line, column, match[0], "a finite number")
        count += 1
    whole = [column for column, name in enumerate(names) if name in WHOLE]
    for line, text in enumerate(rows.split(b"\n")):
        fields = text.strip().split(b",")
        for column in whole if len(fields) == len(names) else ():
            if not fields[column].isdigit() and is_number(fields[column]):
                found = found or (line, column, fields[column], "a whole number >= 0")
                count += 1
    if not found:
        return []
    line, column, got, allowed = found
    shown_text = shown(got.decode(errors="replace")) if got else "an empty field"
    others = f" ({count} such fields)" if count > 1 else ""
    return [f"line {line + 3}: {names[column]}: got {shown_text}; allowed: {allowed}{others}"]
