#include "bench/performance/figures.h"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace scumble::bench {

void Report::Say(const std::string& text) const { std::fprintf(stderr, "%s\n", text.c_str()); }

void Report::Add(Figure figure) { figures_.push_back(std::move(figure)); }

std::string Report::ToJson() const {
  nlohmann::ordered_json figures = nlohmann::ordered_json::array();
  for (const Figure& figure : figures_) {
    nlohmann::ordered_json line = {
        {"item", figure.item},       {"what", figure.what},           {"frame", figure.frame},
        {"unit", figure.unit},       {"median", figure.value.median}, {"low", figure.value.low},
        {"high", figure.value.high}, {"least", figure.value.least},   {"rounds", figure.value.count}};
    if (figure.target) line["target"] = *figure.target, line["at_least"] = figure.at_least;
    if (!figure.note.empty()) line["note"] = figure.note;
    for (const auto& [name, value] : figure.more) line["more"][name] = value;
    figures.push_back(std::move(line));
  }
  return nlohmann::ordered_json{{"figures", figures}, {"notes", notes_}}.dump(2) + "\n";
}

Spread Exactly(double value) { return {value, value, value, value, 1}; }

}  // namespace scumble::bench
