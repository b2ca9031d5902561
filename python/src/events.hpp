// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "lidarena/dataset/dataset.hpp"
#include "python/src/bindings.hpp"

namespace lidarena::python {

/// The next event as (sensor id, ImuSample or Scan); raises StopIteration at the end.
py::tuple next_event(EventSource& source);

/// A stream of events given by Python: an EventSource, a Dataset, or any iterable of (sensor id,
/// ImuSample or Scan). The Python object must outlive it.
class Events {
 public:
  explicit Events(const py::object& given);
  EventSource& source() { return *source_; }

 private:
  std::unique_ptr<EventSource> adapter_;
  EventSource* source_;
};

}  // namespace lidarena::python
