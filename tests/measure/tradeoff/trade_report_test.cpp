// The trade-off as a table, as CSV and as JSON: every form holds the given figures.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <locale>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "measure/tradeoff/parts.h"
#include "tests/measure/tradeoff/trade_report_fixtures.h"

namespace scumble {
namespace {

using Rows = std::vector<std::vector<std::string>>;

// RFC 4180 as it is written there, as a machine of states.
Rows ParseCsv(const std::string& csv) {
  Rows rows(1, {""});
  bool quoted = false;
  for (std::size_t i = 0; i < csv.size(); ++i) {
    std::string& field = rows.back().back();
    if (quoted) {
      if (csv[i] != '"') {
        field += csv[i];
      } else if (i + 1 < csv.size() && csv[i + 1] == '"') {
        field += csv[++i];
      } else {
        quoted = false;
      }
    } else if (csv[i] == '"') {
      quoted = true;
    } else if (csv[i] == ',') {
      rows.back().emplace_back();
    } else if (csv.compare(i, 2, "\r\n") == 0) {
      ++i;
      rows.push_back({""});
    } else {
      field += csv[i];
    }
  }
  EXPECT_FALSE(quoted);
  EXPECT_EQ(rows.back(), std::vector<std::string>{""}) << "the last line ends too";
  rows.pop_back();
  return rows;
}

std::string FieldOf(const Rows& rows, std::size_t variant, const std::string& column) {
  const auto at = std::find(rows[0].begin(), rows[0].end(), column);
  if (at == rows[0].end()) ADD_FAILURE() << "no column " << column;
  return at == rows[0].end() ? "" : rows[variant + 1][static_cast<std::size_t>(at - rows[0].begin())];
}

double NumberOf(const Rows& rows, std::size_t variant, const std::string& column) {
  const std::string text = FieldOf(rows, variant, column);
  double value = 0.0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  EXPECT_TRUE(read.ec == std::errc{} && read.ptr == text.data() + text.size()) << column << ": " << text;
  return value;
}

// Straight from the definition: nothing is better in one and as good in the other.
std::set<std::size_t> PlainFront(const TradeReport& report) {
  std::set<std::size_t> front;
  const auto counts = [](const TradeMeasure& variant) {
    return variant.total_ms.median > 0.0 && variant.texture && !std::isnan(*variant.texture);
  };
  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    const TradeMeasure& a = report.variants[i];
    const bool beaten = std::any_of(report.variants.begin(), report.variants.end(), [&](const TradeMeasure& b) {
      return counts(b) && b.total_ms.median <= a.total_ms.median && *b.texture <= *a.texture &&
             (b.total_ms.median < a.total_ms.median || *b.texture < *a.texture);
    });
    if (counts(a) && !beaten) front.insert(i);
  }
  return front;
}

std::size_t Characters(const std::string& utf8) {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(TradeReport, TheFrontIsWhatNothingDominates) {
  TradeReport report;
  std::uint32_t state = 1;
  const auto next = [&state] { return (state = state * 1664525u + 1013904223u) >> 28; };
  for (int round = 0; round < 50; ++round) {
    report.variants.clear();
    // Few different values, so that many tie; 0 ms and NaN were not measured.
    for (int i = 0; i < 12; ++i)
      report.variants.push_back(MadeUpVariant("axis", std::to_string(i), next() % 8, next() % 8));
    report.variants[3].texture = kNoNumber;
    const std::vector<std::size_t> front = FrontOf(report);
    EXPECT_EQ(std::set<std::size_t>(front.begin(), front.end()), PlainFront(report));
    EXPECT_TRUE(std::is_sorted(front.begin(), front.end(), [&](std::size_t a, std::size_t b) {
      return report.variants[a].total_ms.median < report.variants[b].total_ms.median;
    }));
    // The best of all, by chance alone: it is not there, and pushes nothing off.
    report.variants.push_back(MadeUpVariant("seed", "+1", 1, 0));
    report.variants.back().by_chance = true;
    EXPECT_EQ(FrontOf(report), front);
  }
}

// Other seeds of the style differ by 0.2 at most: what is nearer by less is not worth its time.
TEST(TradeReport, TheFrontIsNotMadeByChance) {
  TradeReport report;
  report.variants = {MadeUpVariant("axis", "style", 10.0, 1.0), MadeUpVariant("axis", "a little nearer", 12.0, 0.85),
                     MadeUpVariant("axis", "nearer", 14.0, 0.7), MadeUpVariant("seed", "+1", 10.0, 1.1),
                     MadeUpVariant("seed", "+2", 10.0, 0.8)};
  report.variants[0].chosen = true;
  EXPECT_FALSE(ChanceOf(report)) << "no other seed";
  report.variants[3].by_chance = true;
  EXPECT_NEAR(ChanceOf(report).value(), 0.1, 1e-12);
  report.variants[4].by_chance = true;
  EXPECT_NEAR(ChanceOf(report).value(), 0.2, 1e-12);
  EXPECT_EQ(FrontOf(report), (std::vector<std::size_t>{0, 2}));
}

// Of equal pictures the first variant is on the front, whatever the timing noise; a later one only if even the upper
// quartile of its total is below the first's lower one.
TEST(TradeReport, TheFrontHasAPictureOnce) {
  TradeReport report;
  for (const char* name : {"style", "again", "other"})
    report.variants.push_back(MadeUpVariant("axis", name, 10.0, 1.0));
  report.variants[2].texture = 2.0;
  report.variants[0].total_ms = {10.0, 9.0, 11.0};
  report.variants[1].same_as = 0;
  report.variants[1].total_ms = {8.5, 8.4, 9.1};
  report.variants[2].total_ms = {9.8, 9.7, 9.9};
  EXPECT_EQ(FrontOf(report), (std::vector<std::size_t>{2, 0})) << "not pushed off by the one that is not there";
  report.variants[1].total_ms = {8.5, 8.5, 8.5};
  EXPECT_EQ(FrontOf(report), (std::vector<std::size_t>{2, 0})) << "one run says nothing";
  report.variants[1].total_ms = {8.5, 8.4, 8.6};
  EXPECT_EQ(FrontOf(report), std::vector<std::size_t>{1});
}

// A method that draws an equal picture in half the time of the transfer, from equal guides, is the one to choose.
TEST(TradeReport, AQuickerTransferOfTheSamePictureCounts) {
  TradeReport report;
  for (const char* name : {"slow", "quick", "quickest"})
    report.variants.push_back(MadeUpVariant("axis", name, 20.0, 1.0));
  for (TradeMeasure& variant : report.variants) variant.guides_ms = {10.0, 9.0, 11.0};
  report.variants[0].total_ms = {20.0, 19.0, 21.0};
  report.variants[1].same_as = report.variants[2].same_as = 0;
  report.variants[1].total_ms = {15.0, 14.0, 16.0};
  report.variants[2].total_ms = {20.0, 19.0, 21.0};
  EXPECT_EQ(FrontOf(report), std::vector<std::size_t>{1});
  report.variants[2].total_ms = {13.0, 12.0, 13.9};
  EXPECT_EQ(FrontOf(report), std::vector<std::size_t>{2}) << "the quickest, and no other of that picture";
  report.variants[2].total_ms = {13.0, 12.0, 14.1};
  EXPECT_EQ(FrontOf(report), std::vector<std::size_t>{1}) << "too near to call: the first of the two";
}

// A table of 256 cells comes first and cannot be chosen, one of 512 has options and makes an equal picture: that one is
// on the front, though it is the slower one.
TEST(TradeReport, APictureIsStoodForByAWayThatCanBeChosen) {
  TradeReport report;
  for (const char* name : {"style", "256", "512", "again"})
    report.variants.push_back(MadeUpVariant("nearest", name, 10.0, 1.0));
  report.variants[0].texture = 2.0;
  report.variants[1].options.clear();
  report.variants[1].total_ms = {5.0, 4.9, 5.1};
  report.variants[2].same_as = report.variants[3].same_as = 1;
  EXPECT_EQ(FrontOf(report), std::vector<std::size_t>{2});
  EXPECT_EQ(internal::MayBeOnFront(report), (std::vector<bool>{true, false, true, false}));
  report.variants[2].by_chance = true;
  EXPECT_EQ(FrontOf(report), std::vector<std::size_t>{3}) << "nor does chance stand for anything";
  report.variants[2].by_chance = false;
  report.variants[2].total_ms = {};
  EXPECT_EQ(FrontOf(report), std::vector<std::size_t>{3}) << "nor what was not timed";
}

// Table, JSON and chart show one front: each ringed point is on it, and there is none for memory.
TEST(TradeReport, TheChartRingsTheFront) {
  TradeReport report = MadeUpReport();
  report.variants.push_back(MadeUpVariant("levels", "9", 4.0, 0.5));
  report.variants.back().same_as = 2;
  report.variants.back().total_ms.upper = report.variants[2].total_ms.upper;  // not surely quicker
  report.variants.push_back(MadeUpVariant("precision", "8 bits", 3.0, 0.4));
  report.variants.back().options.clear();  // nothing makes it
  const std::vector<bool> front = internal::OnFront(report);
  const auto ringed = [&report](internal::ChartTime time) {
    const std::string svg = internal::DrawTradeChart(report, {time, internal::ChartError::kTexture, true});
    std::vector<bool> rings;
    for (std::size_t i = 0; i < report.variants.size(); ++i) {
      const std::size_t begin = svg.find(fmt::format("<a href=\"#variant-{}\"", i + 1)), end = svg.find("</a>", begin);
      rings.push_back(svg.substr(begin, end - begin).find("class=\"ring\"") != std::string::npos);
    }
    return rings;
  };
  EXPECT_EQ(ringed(internal::ChartTime::kTotal), front);
  EXPECT_FALSE(front[6] || front[7]);
  EXPECT_EQ(ringed(internal::ChartTime::kMemory), std::vector<bool>(report.variants.size(), false));
  report.variants[7].options = "--anything";
  EXPECT_EQ(ringed(internal::ChartTime::kTotal), internal::OnFront(report));
  EXPECT_EQ(FrontOf(report), std::vector<std::size_t>{7}) << "otherwise it would be the best of all";
}

TEST(TradeReport, TheChartRingsNothingThatIsChance) {
  TradeReport report = MadeUpReport();
  const auto rings = [&report] {
    const std::string svg = TradeChart(report);
    int count = 0;
    for (std::size_t at = svg.find("class=\"ring\""); at != std::string::npos; at = svg.find("class=\"ring\"", at + 1))
      ++count;
    return count;
  };
  const int before = rings();
  report.variants.push_back(MadeUpVariant("seed", "+1", 1, 0.49));
  report.variants.back().by_chance = true;
  EXPECT_EQ(rings(), before);
  report.variants.back().by_chance = false;
  EXPECT_LT(rings(), before) << "it would be better than most";
}

TEST(TradeReport, AxesComeInTheOrderInWhichTheyAreFirstNamed) {
  EXPECT_EQ(ByAxis(MadeUpReport()), (std::vector<std::size_t>{0, 1, 3, 2, 4, 5}));
}

TEST(TradeReport, PictureNamesAreUniqueAndSafeForEveryFileSystem) {
  TradeReport report = HostileReport();
  report.variants.push_back(report.variants[1]);
  report.variants[2].name = "../..";
  std::set<std::string> names;
  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    const std::string name = TradePictureName(report, i);
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-."), std::string::npos) << name;
    EXPECT_EQ(std::count(name.begin(), name.end(), '.'), 1) << name;
  }
  EXPECT_EQ(TradePictureName(report, 0), "01-the-style.png");
  EXPECT_EQ(TradePictureName(report, 1), "02-comma-and-quote-line.png");
  EXPECT_EQ(TradePictureName(report, 2), "03.png");
}

TEST(TradeReport, CsvReadsBackToTheSameTextsAndValues) {
  const TradeReport report = HostileReport();
  const Rows rows = ParseCsv(TradeCsv(report));
  ASSERT_EQ(rows.size(), report.variants.size() + 1);
  const std::set<std::size_t> front = PlainFront(report);
  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    ASSERT_EQ(rows[i + 1].size(), rows[0].size());
    const TradeMeasure& variant = report.variants[i];
    EXPECT_EQ(FieldOf(rows, i, "variant"), variant.name);
    EXPECT_EQ(FieldOf(rows, i, "axis"), variant.axis);
    EXPECT_EQ(FieldOf(rows, i, "value"), variant.value);
    EXPECT_EQ(FieldOf(rows, i, "options"), variant.options);
    EXPECT_EQ(FieldOf(rows, i, "note"), variant.note);
    EXPECT_EQ(FieldOf(rows, i, "front"), front.count(i) ? "1" : "0");
    EXPECT_EQ(FieldOf(rows, i, "chosen"), i == 0 ? "1" : "0");
    EXPECT_EQ(FieldOf(rows, i, "exact"), i == 5 ? "1" : "0");
    EXPECT_EQ(NumberOf(rows, i, "guides_ms_median"), variant.guides_ms.median);
    EXPECT_EQ(NumberOf(rows, i, "transfer_ms_lower_quartile"), variant.transfer_ms.lower);
    EXPECT_EQ(NumberOf(rows, i, "total_ms_upper_quartile"), variant.total_ms.upper);
    EXPECT_EQ(NumberOf(rows, i, "prepare_ms"), variant.prepare_ms);
    EXPECT_EQ(NumberOf(rows, i, "memory_bytes"), double(variant.memory_bytes));
    EXPECT_EQ(NumberOf(rows, i, "both"), variant.both.mean);
    EXPECT_EQ(NumberOf(rows, i, "both_standard_error"), variant.both.standard_error);
    EXPECT_EQ(NumberOf(rows, i, "energy"), variant.energy.mean);
    EXPECT_EQ(NumberOf(rows, i, "missing_standard_error"), variant.missing.standard_error);
    EXPECT_EQ(NumberOf(rows, i, "texture"), *variant.texture);
    EXPECT_EQ(NumberOf(rows, i, "guide_degrees"), *variant.guide_degrees);
    EXPECT_EQ(NumberOf(rows, i, "coherence"), *variant.coherence);
    EXPECT_EQ(NumberOf(rows, i, "chunk_area_pixels"), *variant.chunk_area);
    EXPECT_EQ(NumberOf(rows, i, "seam_excess"), *variant.seam_excess);
    EXPECT_EQ(NumberOf(rows, i, "repetition"), *variant.repetition);
    EXPECT_EQ(FieldOf(rows, i, "guide_rms"), i == 3 ? "0.001" : "");
    EXPECT_EQ(FieldOf(rows, i, "guide_flip"), i == 3 ? "0.02" : "");
    EXPECT_EQ(FieldOf(rows, i, "picture"), TradePictureName(report, i));
  }
}

// What was not measured, in all variants to say so; and what was measured and is no number.
TradeReport HalfMeasured() {
  TradeReport report = MadeUpReport();
  TradeMeasure& variant = report.variants[1];
  variant = {};
  variant.name = variant.axis = "untimed";
  variant.both.mean = variant.energy.mean = variant.missing.mean = kNoNumber;
  report.variants[2].repetition = kNoNumber;
  report.variants[2].chunk_area = -std::numeric_limits<double>::infinity();
  return report;
}

TEST(TradeReport, WhatWasNotMeasuredIsEmptyInCsv) {
  const Rows rows = ParseCsv(TradeCsv(HalfMeasured()));
  for (std::size_t column = 0; column < rows[0].size(); ++column) {
    const std::string& name = rows[0][column];
    const bool is_text = name == "variant" || name == "axis",
               is_flag = name == "chosen" || name == "exact" || name == "front";
    EXPECT_EQ(rows[2][column], is_text ? "untimed" : is_flag ? "0" : "") << name;
  }
  EXPECT_EQ(FieldOf(rows, 2, "repetition"), "nan");
  EXPECT_EQ(FieldOf(rows, 2, "chunk_area_pixels"), "-inf");
}

// A comma as the decimal point and dots between thousands, as in many countries.
class CommaPunctuation : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(TradeReport, NumbersDoNotFollowTheLocale) {
  const TradeReport report = MadeUpReport();
  const auto all = [&report] { return TradeCsv(report) + TradeJson(report) + TradeChart(report) + TradeHtml(report); };
  const std::string text = all();
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaPunctuation));
  const std::string again = all();
  std::locale::global(before);
  EXPECT_EQ(again, text);
}

TEST(TradeReport, JsonHasTheFiguresOfTheCsv) {
  const TradeReport report = HostileReport();
  const auto json = nlohmann::json::parse(TradeJson(report));
  const Rows rows = ParseCsv(TradeCsv(report));
  EXPECT_EQ(json["scene"], report.scene);
  EXPECT_EQ(json["style"], report.style);
  EXPECT_EQ(json["width"], 960);
  EXPECT_EQ(json["lambda"], 10.0);
  EXPECT_EQ(json["ranked_by"], "texture");
  EXPECT_EQ(json["texture_floor"], 0.25);
  EXPECT_TRUE(json["texture_chance"].is_null()) << "no other seed";
  EXPECT_EQ(json["command"], report.command);
  ASSERT_EQ(json["variants"].size(), report.variants.size());
  std::vector<std::string> front;
  for (const std::size_t i : FrontOf(report)) front.push_back(report.variants[i].name);
  EXPECT_EQ(json["front"], front);
  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    const auto& variant = json["variants"][i];
    for (const char* text : {"variant", "axis", "value", "options", "note", "picture"})
      EXPECT_EQ(variant[text], FieldOf(rows, i, text));
    for (const char* flag : {"chosen", "exact", "front"}) EXPECT_EQ(variant[flag], FieldOf(rows, i, flag) == "1");
    for (const std::string time : {"guides_ms", "transfer_ms", "total_ms"}) {
      EXPECT_EQ(variant[time]["median"], NumberOf(rows, i, time + "_median"));
      EXPECT_EQ(variant[time]["lower_quartile"], NumberOf(rows, i, time + "_lower_quartile"));
      EXPECT_EQ(variant[time]["upper_quartile"], NumberOf(rows, i, time + "_upper_quartile"));
    }
    for (const std::string error : {"both", "energy", "missing"}) {
      EXPECT_EQ(variant[error]["mean"], NumberOf(rows, i, error));
      EXPECT_EQ(variant[error]["standard_error"], NumberOf(rows, i, error + "_standard_error"));
    }
    for (const char* figure : {"prepare_ms", "memory_bytes", "texture", "guide_degrees", "coherence",
                               "chunk_area_pixels", "seam_excess", "repetition"}) {
      EXPECT_EQ(variant[figure], NumberOf(rows, i, figure)) << figure;
    }
  }
  EXPECT_EQ(json["variants"][3]["guide_rms"], 0.001);
  EXPECT_TRUE(json["variants"][2]["guide_rms"].is_null());
}

TEST(TradeReport, JsonSaysNullForWhatWasNotMeasuredAndNamesWhatIsNoNumber) {
  const auto json = nlohmann::json::parse(TradeJson(HalfMeasured()));
  for (const auto& [key, value] : json["variants"][1].items()) {
    EXPECT_TRUE(value.is_null() || value.is_string() || value.is_boolean()) << key << ": " << value;
  }
  EXPECT_EQ(json["variants"][2]["repetition"], "nan");
  EXPECT_EQ(json["variants"][2]["chunk_area_pixels"], "-inf");
}

TEST(TradeReport, JsonHasTheExposureWhereLightIsLookedAt) {
  TradeReport report = MadeUpReport();
  EXPECT_TRUE(nlohmann::json::parse(TradeJson(report))["exposure"].is_null());
  report.exposure = -1.25;
  EXPECT_EQ(nlohmann::json::parse(TradeJson(report))["exposure"], -1.25);
}

TEST(TradeReport, JsonTakesNamesThatAreNotUtf8) {
  TradeReport report = MadeUpReport();
  report.scene = "\xff";
  EXPECT_EQ(nlohmann::json::parse(TradeJson(report))["scene"], "\xEF\xBF\xBD");
}

TEST(TradeReport, TheTableHasALineForEachWayMarksTheFrontAndFitsATerminal) {
  TradeReport report = MadeUpReport();
  report.variants[4].name = "a name that is longer than any variant has ever had and so is cut – somewhere here";
  report.variants[1].total_ms = {10.0, 9.99e3, 1.0e4};
  const std::vector<std::string> lines = LinesOf(TradeTable(report));
  for (const std::string& line : lines) EXPECT_LE(Characters(line), 120u) << line;
  for (std::size_t i = 0; i < report.variants.size(); ++i) {
    const std::string start = report.variants[i].name.substr(0, 8);
    const auto line =
        std::find_if(lines.begin(), lines.end(), [&](const std::string& each) { return each.find(start) == 2; });
    ASSERT_NE(line, lines.end()) << start;
    EXPECT_EQ((*line)[0], PlainFront(report).count(i) ? '*' : ' ') << *line;
  }
  const std::string table = TradeTable(MadeUpReport());
  EXPECT_NE(table.find("40.0 (39.2–42.0)"), std::string::npos);
  EXPECT_NE(table.find("0.500±.012"), std::string::npos);
  EXPECT_NE(table.find("960×540"), std::string::npos);
  EXPECT_NE(table.find("89.7"), std::string::npos) << "coherence";
}

TEST(TradeReport, TheTableSaysNotesAndTheErrorOfGuides) {
  TradeReport report = MadeUpReport();
  report.variants[2].note = "left out";
  report.variants[2].guide_rms = report.variants[2].guide_flip = 0.0;  // the exact ones themselves need no line
  const std::string table = TradeTable(report);
  EXPECT_NE(table.find("  radius 0: left out\n"), std::string::npos);
  EXPECT_NE(table.find("0.0200"), std::string::npos) << "FLIP";
  const std::string guides =
      table.substr(table.find("Guides against"), table.find("\nNotes") - table.find("Guides against"));
  EXPECT_EQ(std::count(guides.begin(), guides.end(), '\n'), 2) << guides;
  EXPECT_EQ(TradeTable(HalfMeasured()).find("nan ("), std::string::npos);
}

TEST(TradeReport, AnEmptyReportIsAnEmptyReport) {
  const TradeReport empty;
  EXPECT_TRUE(FrontOf(empty).empty());
  EXPECT_TRUE(ByAxis(empty).empty());
  EXPECT_EQ(ParseCsv(TradeCsv(empty)).size(), 1u) << "the column names";
  EXPECT_TRUE(nlohmann::json::parse(TradeJson(empty))["variants"].empty());
  EXPECT_NE(TradeTable(empty).find("nothing was measured"), std::string::npos);
}

}  // namespace
}  // namespace scumble
