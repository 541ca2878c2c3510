"""Drives LinuxCNC as its user interface: home, run PROGRAM to its end, for MOST_S at most, and write down what happens.

Rows of FILE: `at LINE TOOL LENGTH J0 J1 J2 J3 J4` (joints as they are, mm and deg), `message TEXT`, `end LINE LIMITS`.
"""
import os
import time

import linuxcnc

MOST_S = float(os.environ["MOST_S"])
command, stat, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()


def do(what, *arguments):
    what(*arguments)
    command.wait_complete()


with open(os.environ["FILE"], "w") as out:

    def look():
        stat.poll()
        message = errors.poll()
        while message:
            print("message", message[1].strip().replace("\n", " "), file=out)
            message = errors.poll()

    for _ in range(100):
        try:
            stat.poll()
            break
        except linuxcnc.error:
            time.sleep(0.1)
    do(command.state, linuxcnc.STATE_ESTOP_RESET)
    do(command.state, linuxcnc.STATE_ON)
    do(command.mode, linuxcnc.MODE_MANUAL)
    do(command.teleop_enable, 0)
    command.home(-1)
    for _ in range(300):
        look()
        if all(stat.homed[: stat.joints]):
            break
        time.sleep(0.1)
    do(command.mode, linuxcnc.MODE_AUTO)
    do(command.program_open, os.environ["PROGRAM"])
    command.auto(linuxcnc.AUTO_RUN, 0)
    start, idle = time.time(), None
    while time.time() - start < MOST_S:
        look()
        joints = " ".join(f"{v:.6f}" for v in stat.joint_actual_position[:5])
        print("at", stat.motion_line, stat.tool_in_spindle, f"{stat.tool_offset[2]:.6f}", joints, file=out)
        resting = stat.interp_state == linuxcnc.INTERP_IDLE and stat.exec_state == linuxcnc.EXEC_DONE
        idle = (idle or time.time()) if resting else None
        if idle and time.time() - idle > 2:
            break
        time.sleep(0.01)
    look()
    print("end", stat.current_line, *stat.limit[:5], file=out)
