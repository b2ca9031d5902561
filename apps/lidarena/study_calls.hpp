// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "apps/lidarena/verbs.hpp"
#include "lidarena/study/study.hpp"

namespace lidarena {

/// A study on this machine by this program, which Ctrl-C ends once listen_to_signals() was called.
study::StudyOptions local_study(const Common& common);
void listen_to_signals();

}  // namespace lidarena
