#include "guidegen/light/path_expression.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <string>

namespace scumble {
namespace {

constexpr int kMaxItems = 60;
constexpr std::string_view kLetters = "LDSE";

// Takes the events in braces or as one letter off the text; empty if the text is no expression.
std::optional<unsigned> TakeEvents(std::string_view& text) {
  const auto letter = [](char c) -> unsigned {
    const std::size_t at = kLetters.find(c);
    return at == std::string_view::npos ? 0u : 1u << at;
  };
  const char first = text.front();
  text.remove_prefix(1);
  if (first == '.') return (1u << kPathEvents) - 1;
  if (first != '[') return letter(first) != 0 ? std::optional(letter(first)) : std::nullopt;
  const std::size_t close = text.find(']');
  if (close == std::string_view::npos || close == 0) return std::nullopt;
  unsigned events = 0;
  for (const char c : text.substr(0, close)) {
    if (letter(c) == 0) return std::nullopt;
    events |= letter(c);
  }
  text.remove_prefix(close + 1);
  return events;
}

// The repetition: from `least` to `most` times; −1 for no limit.
struct Repeat {
  int least = 1;
  int most = 1;
};

std::optional<int> TakeNumber(std::string_view& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || number < 0 || number > kMaxItems) return std::nullopt;
  text.remove_prefix(std::size_t(end - text.data()));
  return number;
}

std::optional<Repeat> TakeRepeat(std::string_view& text) {
  if (text.empty()) return Repeat{};
  const char mark = text.front();
  if (mark != '*' && mark != '+' && mark != '?' && mark != '{') return Repeat{};
  text.remove_prefix(1);
  if (mark == '*') return Repeat{0, -1};
  if (mark == '+') return Repeat{1, -1};
  if (mark == '?') return Repeat{0, 1};
  const std::optional<int> least = TakeNumber(text);
  if (!least || text.empty()) return std::nullopt;
  Repeat repeat{*least, *least};
  if (text.front() == ',') {
    text.remove_prefix(1);
    repeat.most = -1;
    if (!text.empty() && text.front() != '}') {
      const std::optional<int> most = TakeNumber(text);
      if (!most || *most < *least) return std::nullopt;
      repeat.most = *most;
    }
  }
  if (text.empty() || text.front() != '}') return std::nullopt;
  text.remove_prefix(1);
  return repeat;
}

}  // namespace

// One event of the expression: its letters, whether it is optional, whether it may repeat.
struct PathExpression::Item {
  unsigned events;
  bool optional;
  bool again;
};

Expected<PathExpression> PathExpression::Parse(std::string_view text) {
  const Error error =
      UsageError("'" + std::string(text.substr(0, 80)) +
                 "' is no light-path expression: expected L, D, S, E, '.' or sets like [DS], each " +
                 "with an optional *, +, ?, {n}, {m,n} or {m,}, and at most " + std::to_string(kMaxItems) + " events");
  std::vector<Item> items;
  for (std::string_view rest = text; !rest.empty();) {
    const std::optional<unsigned> events = TakeEvents(rest);
    if (!events) return error;
    const std::optional<Repeat> repeat = TakeRepeat(rest);
    if (!repeat) return error;
    items.insert(items.end(), std::size_t(repeat->least), {*events, false, false});
    if (repeat->most < 0) items.push_back({*events, true, true});
    if (repeat->most > repeat->least) {
      items.insert(items.end(), std::size_t(repeat->most - repeat->least), {*events, true, false});
    }
    if (items.size() > kMaxItems) return error;
  }
  if (items.empty()) return error;
  std::reverse(items.begin(), items.end());  // paths are read from the eye
  PathExpression expression;
  expression.Compile(items);
  expression.DropHopeless();
  return expression;
}

// The subset construction. Bit i of a set: the next event may be item i. The last bit: all items are done.
void PathExpression::Compile(const std::vector<Item>& items) {
  const auto close = [&](std::uint64_t set) {
    for (std::size_t i = 0; i < items.size(); ++i) {
      if ((set >> i & 1) != 0 && items[i].optional) set |= std::uint64_t(1) << (i + 1);
    }
    return set;
  };
  std::map<std::uint64_t, State> known;
  std::vector<std::uint64_t> sets;
  const auto number = [&](std::uint64_t set) {
    if (set == 0) return kDead;
    const auto [it, is_new] = known.try_emplace(set, State(sets.size()));
    if (is_new) sets.push_back(set);
    return it->second;
  };
  start_ = number(close(1));
  for (std::size_t n = 0; n < sets.size(); ++n) {
    const std::uint64_t from = sets[n];
    Node node;
    node.accepts = (from >> items.size() & 1) != 0;
    for (int event = 0; event < kPathEvents; ++event) {
      std::uint64_t to = 0;
      for (std::size_t i = 0; i < items.size(); ++i) {
        if ((from >> i & 1) == 0 || (items[i].events >> event & 1) == 0) continue;
        to |= std::uint64_t(1) << (items[i].again ? i : i + 1);
      }
      node.next[std::size_t(event)] = number(close(to));
    }
    nodes_.push_back(node);
  }
}

// States from which no event leads to acceptance become kDead, so that a tracer stops as early as possible.
void PathExpression::DropHopeless() {
  std::vector<bool> hopeful(nodes_.size());
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (hopeful[n]) continue;
      bool hope = nodes_[n].accepts;
      for (const State next : nodes_[n].next) hope = hope || (next != kDead && hopeful[std::size_t(next)]);
      hopeful[n] = hope;
      changed = changed || hope;
    }
  }
  for (Node& node : nodes_) {
    for (State& next : node.next) {
      if (next != kDead && !hopeful[std::size_t(next)]) next = kDead;
    }
  }
}

}  // namespace scumble
