// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/evaluate_evo.hpp"

#include <fmt/format.h>

#include <vector>

#include "lidarena/evaluation/trajectory/compat_evo.hpp"

namespace lidarena {
namespace {

constexpr const char* kGroup = "With --compat evo";

template <class E>
std::vector<std::string> names_of() {
  std::vector<std::string> names;
  for (const auto& [name, value] : enum_names(E{})) names.emplace_back(name);
  return names;
}

/// `name` must be one of names_of<E>(), which the command-line parser checks.
template <class E>
E value_of(const std::string& name) {
  for (const auto& [known, value] : enum_names(E{})) {
    if (name == known) return value;
  }
  throw InputError(name, "is not known");
}

evaluation::EvoOptions options_of(const EvoArguments& a) {
  evaluation::EvoOptions o;
  o.metric = value_of<evaluation::EvoMetric>(a.metric);
  o.relation = value_of<evaluation::EvoRelation>(a.relation);
  o.unit = value_of<evaluation::EvoUnit>(a.unit);
  o.delta = a.delta;
  o.delta_tolerance = a.delta_tolerance;
  o.all_pairs = a.all_pairs;
  o.pairs_from_reference = a.pairs_from_reference;
  o.align = a.align;
  o.scale = a.scale;
  o.align_origin = a.origin;
  o.n_to_align = a.n_to_align;
  o.max_difference_s = a.t_max_diff;
  o.offset_s = a.t_offset;
  return o;
}

Json options_json(const EvoArguments& a) {
  Json json{{"relation", a.relation},     {"t_max_diff_s", a.t_max_diff},
            {"t_offset_s", a.t_offset},   {"align", a.align},
            {"scale", a.scale},           {"align_origin", a.origin},
            {"n_to_align", a.n_to_align}, {"metric", a.metric}};
  if (a.metric != "rpe") return json;
  json["delta"] = a.delta;
  json["delta_unit"] = a.unit;
  json["delta_tolerance"] = a.delta_tolerance;
  json["all_pairs"] = a.all_pairs;
  json["pairs_from_reference"] = a.pairs_from_reference;
  return json;
}

}  // namespace

void add_evo_options(CLI::App& verb, EvoArguments& a) {
  auto* compat =
      verb.add_option("--compat", a.tool, "Compute the metrics as another tool does: evo")
          ->check(CLI::IsMember({"evo"}))
          ->group(kGroup);
  const auto flag = [&](const char* name, bool& value, const char* help) {
    verb.add_flag(name, value, help)->needs(compat)->group(kGroup);
  };
  const auto choice = [&](const char* name, std::string& value, const char* help,
                          const std::vector<std::string>& names) {
    auto* option = verb.add_option(name, value, help)->check(CLI::IsMember(names));
    option->needs(compat)->group(kGroup)->capture_default_str();
  };
  const auto option = [&](const char* name, auto& value, const char* help) {
    verb.add_option(name, value, help)->needs(compat)->group(kGroup)->capture_default_str();
  };
  choice("--metric", a.metric, "Absolute or relative pose error",
         names_of<evaluation::EvoMetric>());
  choice("--relation", a.relation, "Part of the pose error that is measured",
         names_of<evaluation::EvoRelation>());
  option("--t-max-diff", a.t_max_diff, "Maximum difference of stamps that are matched, s");
  option("--t-offset", a.t_offset, "Added to the estimate's stamps, s");
  flag("--align", a.align, "Align by rotation and translation");
  flag("--scale", a.scale, "Fit the scale; with --align: a similarity transform");
  flag("--origin", a.origin, "Make the first poses coincide");
  option("--n-to-align", a.n_to_align, "Fit only the first N pairs, 0 = all");
  option("--delta", a.delta, "Distance between the two poses of a pair (rpe), in --unit");
  choice("--unit", a.unit, "Unit of --delta: frames, meters, degrees, radians",
         names_of<evaluation::EvoUnit>());
  option("--delta-tolerance", a.delta_tolerance, "Tolerance relative to --delta, with --all-pairs");
  flag("--all-pairs", a.all_pairs, "A pair starts at every pose, else consecutive pairs");
  flag("--pairs-from-reference", a.pairs_from_reference,
       "Measure path and angle of pairs on the truth");
}

Json evo_json(std::span<const StampedPose> truth, std::span<const StampedPose> estimate,
              const EvoArguments& arguments) {
  const evaluation::EvoOptions options = options_of(arguments);
  const evaluation::EvoResult result = evaluation::compat_evo(truth, estimate, options);
  const evaluation::EvoStatistics& s = result.statistics;
  const evaluation::Similarity& alignment = result.reference_from_estimate;
  const Pose pose = make_pose(alignment.rotation, alignment.translation);
  return {{"compat", "evo"},
          {"options", options_json(arguments)},
          {"reference_poses", truth.size()},
          {"estimate_poses", estimate.size()},
          {"matched", result.matched},
          {"errors", result.errors.size()},
          {"reference_from_estimate_m_quaternion", value_to_json(pose)},
          {"scale", alignment.scale},
          {"unit", evaluation::unit_of(options.relation)},
          {"statistics",
           {{"rmse", s.rmse},
            {"mean", s.mean},
            {"median", s.median},
            {"std", s.std},
            {"min", s.min},
            {"max", s.max},
            {"sse", s.sse}}}};
}

std::string evo_text(const Json& result) {
  std::string text = fmt::format(
      "evo's {} of {}: {} of {} estimated and {} true poses matched, {} errors\n",
      result.at("options").at("metric").get<std::string>(),
      result.at("options").at("relation").get<std::string>(),
      result.at("matched").get<std::size_t>(), result.at("estimate_poses").get<std::size_t>(),
      result.at("reference_poses").get<std::size_t>(), result.at("errors").get<std::size_t>());
  const std::string unit = result.at("unit").get<std::string>();
  for (const char* name : {"rmse", "mean", "median", "std", "min", "max", "sse"}) {
    const std::string of = unit.empty() || std::string(name) != "sse" ? unit : unit + "^2";
    text += fmt::format("  {:<8}{:>18.12g} {}", name,
                        result.at("statistics").at(name).get<double>(), of);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

}  // namespace lidarena
