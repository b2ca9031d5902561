// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "lidarena/dataset/dataset.hpp"
#include "python/src/bindings.hpp"

namespace lidarena::python {

/// (sensor id, ImuSample or Scan); stops a Python iteration at the end.
py::tuple next_event(EventSource& source);

/// What Python hands in as a stream of events: an EventSource, a Dataset, or any iterable of
/// (sensor id, ImuSample or Scan). Lives while the Python object does.
class Events {
 public:
  explicit Events(const py::object& given);
  EventSource& source() { return *source_; }

 private:
  std::unique_ptr<EventSource> adapter_;
  EventSource* source_;
};

}  // namespace lidarena::python
