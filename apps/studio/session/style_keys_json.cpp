#include "apps/studio/style_keys_json.h"

#include <cmath>

namespace scumble {
namespace {

nlohmann::ordered_json JsonOf(const KeyValue& value) {
  return std::visit(
      [](const auto& one) -> nlohmann::ordered_json {
        if constexpr (std::is_same_v<std::decay_t<decltype(one)>, double>) {
          if (!std::isfinite(one)) return nullptr;
        }
        return one;
      },
      value);
}

}  // namespace

nlohmann::ordered_json StyleKeysJson() {
  nlohmann::ordered_json keys = nlohmann::ordered_json::array();
  for (const StyleKey& key : StyleKeys()) {
    const bool is_number = key.kind == KeyKind::kNumber || key.kind == KeyKind::kWhole;
    const auto number = [&](double value) -> nlohmann::ordered_json {
      if (!is_number) return nullptr;
      if (key.kind == KeyKind::kWhole) return static_cast<std::int64_t>(value);
      return value;
    };
    nlohmann::ordered_json choices;
    if (key.kind == KeyKind::kChoice) choices = key.choices;
    keys.push_back({{"name", key.name},
                    {"default", JsonOf(key.Default())},
                    {"help", key.help},
                    {"kind", KindName(key.kind)},
                    {"least", number(key.least)},
                    {"most", number(key.most)},
                    {"unlimited", key.unlimited},
                    {"step", number(key.step)},
                    {"choices", choices},
                    {"group", key.group},
                    {"needs_preparing", key.needs_preparing}});
  }
  return keys;
}

}  // namespace scumble
