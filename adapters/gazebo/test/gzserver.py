# SPDX-License-Identifier: BSD-3-Clause
"""Starts Gazebo Classic's server without display, network or model database."""
import os
import pathlib
import re
import socket
import subprocess


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def run(world, plugins, models=(), limit_s=300, extra=None, arguments=()):
    """Runs a server until the world ends it; returns its exit status and output."""
    env = dict(os.environ)
    env.update({
        "GAZEBO_MASTER_URI": f"http://127.0.0.1:{free_port()}", "GAZEBO_IP": "127.0.0.1",
        "IGN_IP": "127.0.0.1", "GAZEBO_MODEL_DATABASE_URI": "",
        "GAZEBO_PLUGIN_PATH": str(pathlib.Path(plugins).resolve()),
        "GAZEBO_MODEL_PATH": ":".join(str(pathlib.Path(m).resolve()) for m in models),
        "GAZEBO_RESOURCE_PATH": "/usr/share/gazebo-11",
    })
    env.update(extra or {})
    done = subprocess.run(["gzserver", "--verbose", *arguments, str(world)], env=env, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=limit_s)
    return done.returncode, re.sub(r"\x1b\[[0-9;]*m", "", done.stdout)  # without colors
