// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/parallel.hpp"

namespace lidarena::evaluation {

inline const Parallel kTwoThreads(2);

}  // namespace lidarena::evaluation
