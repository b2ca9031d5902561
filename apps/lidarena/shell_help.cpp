// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/shell_help.hpp"

#include <fmt/format.h>

#include <map>
#include <vector>

namespace lidarena {
namespace {

using Verbs = std::vector<const CLI::App*>;

Verbs verbs_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// Escapes text for troff: control characters at the start of a line, backslashes and hyphens.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool line_begins = out.empty() || out.back() == '\n';
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::vector<std::string> flags_of(const CLI::Option& option) {
  std::vector<std::string> flags;
  for (const std::string& name : option.get_lnames()) flags.push_back("--" + name);
  for (const std::string& name : option.get_snames()) flags.push_back("-" + name);
  return flags;
}

std::string man_option(const CLI::Option& option) {
  const std::vector<std::string> flags = flags_of(option);
  std::string name;
  for (const std::string& flag : flags) name += (name.empty() ? "" : ", ") + flag;
  if (flags.empty()) name = option.get_name(true);
  std::string entry = fmt::format(".TP\n\\fB{}\\fR", troff(name));
  if (!flags.empty() && option.get_items_expected_max() > 0) {
    entry += fmt::format(" \\fI{}\\fR", troff(option.get_type_name()));
  }
  entry += "\n" + troff(option.get_description());
  if (!option.get_default_str().empty()) {
    entry += fmt::format(" (default: {})", troff(option.get_default_str()));
  }
  return entry + "\n";
}

std::string man_verb(const CLI::App& verb) {
  std::string text = fmt::format(".SS {}\n{}\n", verb.get_name(), troff(verb.get_description()));
  for (const CLI::Option* option : verb.get_options()) text += man_option(*option);
  return text;
}

/// The words between the braces of "TEXT:{a,b,c}"; empty if any value is allowed.
std::vector<std::string> allowed_words(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

/// KIND of `lidarena list` whose names this option (or the verb's argument) takes; empty if none.
std::string names_for(const std::string& verb, const std::string& option) {
  static const std::map<std::string, std::string> kinds{
      {"--world", "worlds"},    {"--flight", "flights"},       {"--sensor", "sensors"},
      {"--sensors", "sensors"}, {"run", "algorithms"},         {"study", "studies"},
      {"info", "sensors"},      {"--algorithms", "algorithms"}};
  const auto found = kinds.find(option.empty() ? verb : option);
  return found == kinds.end() ? "" : found->second;
}

constexpr const char* kNames = R"sh(# names printed by `lidarena list KIND`
_lidarena_names() { lidarena list "$1" 2>/dev/null | awk '$1 != "sensor" { print $1 }'; }
)sh";

constexpr const char* kFunction = R"sh(_lidarena() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} verb=${{COMP_WORDS[1]}}
  local words="" kind=""
  if [ "$COMP_CWORD" = 1 ]; then
    words="{verbs}"
  else
    case "$verb $prev" in
{values}    esac
    if [ -z "$words$kind" ]; then
      case "$verb" in
{options}      esac
      case "$cur" in -*) kind="" ;; *) [ "$COMP_CWORD" = 2 ] || kind="" ;; esac
    fi
  fi
  [ -z "$kind" ] || words="$words $(_lidarena_names "$kind")"
  COMPREPLY=($(compgen -W "$words" -- "$cur"))
  case "$cur" in -*) ;; *) COMPREPLY+=($(compgen -f -- "$cur")) ;; esac
}}
complete -o filenames -F _lidarena lidarena
)sh";

}  // namespace

std::string man_page(const CLI::App& app) {
  std::string text = fmt::format(
      ".TH LIDARENA 1 \"\" \"lidarena {}\" \"Lidarena\"\n.SH NAME\nlidarena \\- LiDAR simulation, "
      "SLAM and scoring in mesh worlds\n.SH SYNOPSIS\n\\fBlidarena\\fR \\fIverb\\fR "
      "[\\fIoption\\fR ...]\n.SH DESCRIPTION\n.nf\n{}\n.fi\n.SH VERBS\n",
      LIDARENA_VERSION, troff(app.get_description()));
  for (const CLI::App* verb : verbs_of(app)) text += man_verb(*verb);
  return text +
         ".SH EXIT STATUS\n0: done; 1: the work failed (a run diverged); 2: wrong usage or bad "
         "input; 75: a study was asked to end, another call goes on.\n.SH "
         "FILES\n.TP\n\\fIconfigs/\\fR\nNamed worlds, flights, sensors, odometry and "
         "studies: the nearest such folder in the working folder or above it, else the installed "
         "one.\n";
}

std::string bash_completion(const CLI::App& app) {
  std::string verbs, values, options;
  for (const CLI::App* verb : verbs_of(app)) {
    verbs += (verbs.empty() ? "" : " ") + verb->get_name();
    std::string flags;
    std::string own_words;
    for (const CLI::Option* option : verb->get_options()) {
      const std::string words = fmt::format("{}", fmt::join(allowed_words(*option), " "));
      if (flags_of(*option).empty()) own_words += words;
      for (const std::string& flag : flags_of(*option)) {
        flags += (flags.empty() ? "" : " ") + flag;
        const std::string kind = names_for(verb->get_name(), flag);
        if (!words.empty() || !kind.empty()) {
          values += fmt::format("      \"{} {}\") words=\"{}\" kind=\"{}\" ;;\n", verb->get_name(),
                                flag, words, kind);
        }
      }
    }
    options += fmt::format(
        "        {}) case \"$cur\" in -*) words=\"{}\" ;; *) words=\"{}\" kind=\"{}\" ;; esac ;;\n",
        verb->get_name(), flags, own_words, names_for(verb->get_name(), ""));
  }
  using fmt::arg;
  return "# bash completion of lidarena, generated by `lidarena completion`\n" +
         std::string(kNames) +
         fmt::format(kFunction, arg("verbs", verbs), arg("values", values),
                     arg("options", options));
}

}  // namespace lidarena
