// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/json_file.hpp"

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/text_file.hpp"

namespace lidarena::dataset {

Json read_json(const std::filesystem::path& file) {
  const std::string text = read_bytes(file);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw InputError(file.string() + ": byte " + std::to_string(error.byte), "is not valid JSON",
                     "the file is damaged or incomplete; write it again");
  }
}

void write_json(const std::filesystem::path& file, const Json& json) {
  write_text_file(file, json.dump(2) + "\n");
}

}  // namespace lidarena::dataset
