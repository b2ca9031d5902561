// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/schema.hpp"

#include <fmt/format.h>

#include "apps/lidarena/verbs.hpp"
#include "lidarena/base/config_schema.hpp"
#include "lidarena/dataset/dataset_manifest.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/run_manifest.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/report/page_data.hpp"
#include "lidarena/results/run_metrics.hpp"
#include "lidarena/scenes/world_config.hpp"
#include "lidarena/sensor/sensor_config.hpp"
#include "lidarena/stages/check_recording.hpp"
#include "lidarena/study/improvement.hpp"
#include "lidarena/study/study_spec.hpp"

namespace lidarena {

std::map<std::string, std::function<Json()>> schemas() {
  std::map<std::string, std::function<Json()>> all{
      {"world", [] { return schema_document<scenes::WorldConfig>("A world of Lidarena"); }},
      {"flight", [] { return schema_document<flight::FlightConfig>("A flight of Lidarena"); }},
      {"sensor", [] { return schema_document<sensor::SensorFile>("A sensor of Lidarena"); }},
      {"beams",
       [] { return schema_document<sensor::SpinningHead>("The beams of a spinning head"); }},
      {"external",
       [] { return schema_document<stages::ExternalProgram>("A SLAM program of others"); }},
      {"study", [] { return schema_document<study::StudySpec>("A study of Lidarena"); }},
      {"recording",
       [] { return schema_document<study::StudyRecording>("A recording of a study"); }},
      {"steps",
       [] { return schema_document<study::ImprovementSteps>("Steps of lidarena improve"); }},
      {"run", [] { return schema_document<dataset::RunManifest>("manifest.json of a run"); }},
      {"dataset",
       [] { return schema_document<dataset::DatasetManifest>("manifest.json of a dataset"); }},
      {"metrics",
       [] { return schema_document<results::RunMetrics>("metrics.json of a run of Lidarena"); }},
      {"report",
       [] { return schema_document<report::ReportData>("report.json of a report of Lidarena"); }},
      {"check",
       [] { return schema_document<stages::CheckPage>("The data of a page of lidarena check"); }}};
  for (const odometry::AlgorithmInfo& info : odometry::list_algorithms()) {
    all[info.name] = [name = info.name] { return odometry::algorithm_schema(name); };
  }
  return all;
}

namespace {

Json schema_of(const std::string& kind) {
  const auto all = schemas();
  const auto found = all.find(kind);
  if (found != all.end()) return found->second();
  std::string known;
  for (const auto& [name, make] : all) known += (known.empty() ? "" : ", ") + name;
  throw InputError(kind, "is not a kind of file with a schema", "known: " + known);
}

int write_all(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const auto& [name, make] : schemas())
    dataset::write_json(folder / (name + ".schema.json"), make());
  return kDone;
}

}  // namespace

void add_schema(CLI::App& app, Common& common, int& exit_code) {
  auto* verb =
      app.add_subcommand("schema", "JSON Schema of a kind of file: keys, units, defaults, limits");
  auto kind = std::make_shared<std::string>();
  auto out = std::make_shared<std::string>();
  verb->add_option("kind", *kind,
                   "world, flight, sensor, beams, study, external, recording, steps, run, dataset, "
                   "metrics, report, check, or an algorithm");
  verb->add_option("--out", *out, "Folder to write all schemas to, as KIND.schema.json");
  set_verb(
      *verb, common,
      [kind, out] {
        if (kind->empty() == out->empty()) {
          throw InputError("schema", "needs either a kind, or --out FOLDER to write all schemas");
        }
        if (!out->empty()) return write_all(*out);
        print_json(schema_of(*kind));
        return kDone;
      },
      exit_code);
}

}  // namespace lidarena
