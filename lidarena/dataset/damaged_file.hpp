// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/error.hpp"

namespace lidarena::dataset {

/// A file that is cut off or damaged: what was read of it before is intact.
class DamagedFile : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace lidarena::dataset
