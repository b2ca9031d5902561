// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// For the one source of a plugin that registers it; see gz_sim.hpp.
#ifdef LIDARENA_GZ_SIM
#include <gz/plugin/Register.hh>
#define LIDARENA_ADD_PLUGIN GZ_ADD_PLUGIN
#define LIDARENA_ADD_PLUGIN_ALIAS GZ_ADD_PLUGIN_ALIAS
#else
#include <ignition/plugin/Register.hh>
#define LIDARENA_ADD_PLUGIN IGNITION_ADD_PLUGIN
#define LIDARENA_ADD_PLUGIN_ALIAS IGNITION_ADD_PLUGIN_ALIAS
#endif
