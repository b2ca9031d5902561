#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the CPU time of the sensors in the House. usage: costs.py BUILD_FOLDER PREPARED_FOLDER
PREPARED_FOLDER is written by adapters/gazebo/prepare. Each run simulates three seconds as fast as
possible; the plugin prints its own CPU time and that of the process.
"""
import pathlib
import re
import sys

import gzserver

STOCK = """<sensor type="ray" name="stock"><always_on>1</always_on><update_rate>10</update_rate>
<ray><scan><horizontal><samples>200</samples><min_angle>-3.14</min_angle><max_angle>3.14</max_angle></horizontal>
<vertical><samples>100</samples><min_angle>-0.12</min_angle><max_angle>0.9</max_angle></vertical></scan>
<range><min>0.1</min><max>70</max></range></ray></sensor>
"""


def variant(text, sensor, extra="", stock=False):
    text = text.replace("<sensor>livox_mid360</sensor>", f"<sensor>{sensor}</sensor>{extra}")
    text = re.sub(r"<record>.*</record>", "", text)
    text = re.sub(r"<record_seconds>.*</record_seconds>", "<record_seconds>3</record_seconds>", text)
    text = text.replace("<real_time_update_rate>1000<", "<real_time_update_rate>0<")
    if stock:
        text = text.replace("</link>", STOCK + "</link>")
    return text


def main():
    plugins, ready = sys.argv[1], pathlib.Path(sys.argv[2])
    text = (ready / "house.world").read_text()
    worlds = {
        "Mid-360": variant(text, "livox_mid360"),
        "Mid-360 and Gazebo's ray sensor, 20,000 rays at 10 Hz": variant(text, "livox_mid360", stock=True),
        "OS0-128 1024x10": variant(text, "ouster_os0_128"),
        "OS0-128 2048x10": variant(text, "ouster_os0_128_2048"),
        "OS0-128 2048x10, a second thread": variant(text, "ouster_os0_128_2048", "<threads>1</threads>"),
    }
    for name, world in worlds.items():
        file = ready / "costs.world"
        file.write_text(world)
        extra = {"GAZEBO_RESOURCE_PATH": f"/usr/share/gazebo-11:{ready}"}
        _, output = gzserver.run(file, plugins, [ready / "models"], extra=extra, limit_s=580)
        lines = [line for line in output.splitlines() if "CPU:" in line]
        print(f"{name}: {lines[0].split('lidarena: ')[-1] if lines else output[-1500:]}", flush=True)


if __name__ == "__main__":
    main()
