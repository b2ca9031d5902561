// SPDX-License-Identifier: BSD-3-Clause
// What the tests include besides the headers of library.hpp.
#include "library.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
