// The trade-off as a page and as a chart: well-formed, complete, and no text is parsed as markup.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>

#include "tests/measure/tradeoff/trade_report_fixtures.h"

namespace scumble {
namespace {

struct Tag {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::string within;  // names of the elements around it, "html body svg"
};

// Every start tag of a page, with its attributes. Fails the test where an element is not closed, closed twice or
// crossed, an attribute lacks its quotes or comes twice, or a bare < or & stands in text. Scripts and style sheets are
// passed over.
class Markup {
 public:
  explicit Markup(const std::string& markup) : text_(markup) {
    while (at_ < text_.size()) {
      if (text_.compare(at_, 2, "<!") == 0) {
        at_ = text_.find('>', at_) + 1;
      } else if (text_.compare(at_, 2, "</") == 0) {
        Close();
      } else if (text_[at_] == '<') {
        Open();
      } else {
        Character();
      }
    }
    EXPECT_TRUE(open_.empty()) << open_.back();
  }

  std::vector<Tag> All(const std::string& name, const std::string& within = "") const {
    std::vector<Tag> found;
    for (const Tag& tag : tags) {
      if (tag.name == name && tag.within.find(within) != std::string::npos) found.push_back(tag);
    }
    return found;
  }

  std::vector<Tag> tags;
  std::string text;  // outside tags, scripts and style sheets

 private:
  void Character() {
    if (text_[at_] == '&') {
      const std::size_t end = text_.find(';', at_);
      ASSERT_NE(end, std::string::npos);
      const std::set<std::string> known{"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"};
      EXPECT_TRUE(known.count(text_.substr(at_, end - at_ + 1))) << text_.substr(at_, 20);
    }
    text += text_[at_++];
  }

  void Close() {
    const std::size_t end = text_.find('>', at_);
    const std::string name = text_.substr(at_ + 2, end - at_ - 2);
    EXPECT_FALSE(open_.empty());
    at_ = end + 1;
    if (open_.empty()) return;
    EXPECT_EQ(open_.back(), name) << text_.substr(end > 80 ? end - 80 : 0, 120);
    open_.pop_back();
  }

  void Open() {
    const std::size_t end_of_name = text_.find_first_of(" />\n", at_);
    Tag tag{text_.substr(at_ + 1, end_of_name - at_ - 1), {}, ""};
    EXPECT_TRUE(!tag.name.empty() && std::isalpha(static_cast<unsigned char>(tag.name[0]))) << text_.substr(at_, 40);
    for (const std::string& name : open_) tag.within += name + " ";
    at_ = end_of_name;
    while (at_ < text_.size() && text_[at_] != '>' && text_[at_] != '/') Attribute(tag);
    const bool closed = text_[at_] == '/';
    at_ += closed ? 2 : 1;
    tags.push_back(tag);
    static const std::set<std::string> kVoid{"meta", "img", "input", "br"};
    if (closed || kVoid.count(tag.name)) return;
    open_.push_back(tag.name);
    if (tag.name == "script" || tag.name == "style") at_ = text_.find("</" + tag.name, at_);
  }

  void Attribute(Tag& tag) {
    if (text_[at_] == ' ' || text_[at_] == '\n') {
      ++at_;
      return;
    }
    const std::size_t end = text_.find_first_of("= />", at_);
    const std::string name = text_.substr(at_, end - at_);
    std::string value;
    at_ = end;
    if (text_[at_] == '=') {
      EXPECT_EQ(text_[at_ + 1], '"') << tag.name << " " << name;
      const std::size_t close = text_.find('"', at_ + 2);
      value = text_.substr(at_ + 2, close - at_ - 2);
      EXPECT_EQ(value.find('<'), std::string::npos) << value;
      at_ = close + 1;
    }
    EXPECT_TRUE(tag.attributes.emplace(name, value).second) << tag.name << " has two " << name;
  }

  const std::string& text_;
  std::size_t at_ = 0;
  std::vector<std::string> open_;
};

std::set<std::string> IdsOf(const Markup& page) {
  std::set<std::string> ids;
  for (const Tag& tag : page.tags) {
    const auto id = tag.attributes.find("id");
    if (id == tag.attributes.end()) continue;
    EXPECT_TRUE(ids.insert(id->second).second) << id->second << " twice";
  }
  return ids;
}

TEST(TradePage, IsWellFormedAndLoadsNothing) {
  const std::string html = TradeHtml(HostileReport());
  const Markup page(html);
  EXPECT_EQ(html.find("://"), std::string::npos);
  EXPECT_EQ(page.All("link").size(), 0u);
  for (const Tag& script : page.All("script")) EXPECT_TRUE(script.attributes.empty()) << "no source of its own";
  for (const Tag& image : page.All("img"))
    EXPECT_TRUE(image.attributes.at("src").starts_with("data:image/png;base64,"));
}

TEST(TradePage, NamesAreTextAndNotMarkup) {
  const std::string html = TradeHtml(HostileReport());
  const Markup page(html);
  EXPECT_EQ(page.All("script").size(), 1u) << "ours alone";
  EXPECT_EQ(page.All("axis").size() + page.All("note").size() + page.All("i").size(), 0u);
  EXPECT_EQ(html.find("alert(1)</script>"), std::string::npos);
  EXPECT_NE(page.text.find("a&lt;b&gt;&amp;&quot;c&#39;.glb"), std::string::npos);
}

TEST(TradePage, EveryWayHasAFigureALineAndPointsThatLeadToIt) {
  const TradeReport report = MadeUpReport();
  const std::string html = TradeHtml(report);
  const Markup page(html);
  const std::set<std::string> ids = IdsOf(page);
  EXPECT_EQ(page.All("figure").size(), report.variants.size());
  EXPECT_EQ(page.All("tr", "tbody").size(), report.variants.size());
  const std::vector<Tag> points = page.All("a", "svg");
  EXPECT_EQ(points.size(), 12 * report.variants.size()) << "charts of three times by four errors";
  for (std::size_t i = 1; i <= report.variants.size(); ++i) {
    const std::string id = "variant-" + std::to_string(i);
    EXPECT_TRUE(ids.count(id)) << id;
    EXPECT_EQ(
        std::count_if(points.begin(), points.end(), [&](const Tag& a) { return a.attributes.at("href") == "#" + id; }),
        12);
  }
  for (const Tag& link : page.All("a")) EXPECT_TRUE(ids.count(link.attributes.at("href").substr(1)));
  for (const Tag& point : points) EXPECT_FALSE(point.attributes.at("aria-label").empty());
  for (const Tag& image : page.All("img")) EXPECT_FALSE(image.attributes.at("alt").empty());
}

TEST(TradePage, EveryChoiceHasItsStyle) {
  const std::string html = TradeHtml(MadeUpReport());
  const Markup page(html);
  std::size_t axes = 0;
  for (const Tag& input : page.All("input")) {
    const std::string& id = input.attributes.at("id");
    EXPECT_NE(html.find("#" + id + ":"), std::string::npos) << id;
    axes += id.starts_with("axis-");
  }
  EXPECT_EQ(axes, 4u);
}

TEST(TradePage, PicturesAreTheBytesGivenAndEqualOnesAreThereOnce) {
  TradeReport report = MadeUpReport();
  // RFC 4648's own examples: "f", "fo", "foo", "foobar".
  report.variants[0].picture_png = {'f'};
  report.variants[1].picture_png = {'f', 'o'};
  report.variants[2].picture_png = {'f', 'o', 'o'};
  report.variants[3].picture_png = {'f', 'o', 'o', 'b', 'a', 'r'};
  report.variants[4].picture_png = {'f', 'o', 'o'};
  report.variants[5].picture_png = {};
  const std::string html = TradeHtml(report);
  const Markup page(html);
  std::vector<std::string> images;
  for (const Tag& image : page.All("img")) images.push_back(image.attributes.at("src").substr(22));
  EXPECT_EQ(images, (std::vector<std::string>{"Zg==", "Zm8=", "Zm9vYmFy", "Zm9v"})) << "by axis";
  EXPECT_NE(html.find("<figure id=\"variant-5\" class=\"variant\" data-same=\"3\">"), std::string::npos);
  EXPECT_NE(html.find("The same picture as <a href=\"#variant-3\">radius 0</a>"), std::string::npos);
  EXPECT_NE(html.find("No picture was kept"), std::string::npos);
}

TEST(TradePage, SaysWhatIsFasterAndNoWorseThanTheStyle) {
  // "radius 0" takes 30 ms where the style takes 40, for the same error.
  const std::string html = TradeHtml(MadeUpReport());
  EXPECT_NE(
      html.find(
          "Faster, and farther from the exemplar by no more than chance: <a href=\"#variant-3\">radius 0</a> (30.0 ms"),
      std::string::npos);
  EXPECT_NE(html.find("<p>5 of 6 variants are on the front"), std::string::npos);
  TradeReport report = MadeUpReport();
  report.variants[0].total_ms.median = 25.0;
  EXPECT_NE(TradeHtml(report).find(", and is on the front."), std::string::npos);
}

TEST(TradePage, AnEmptyReportAndOneWithoutFiguresAreWholePages) {
  TradeReport bare;
  bare.variants.resize(1);
  for (const TradeReport& report : {TradeReport{}, bare}) {
    const std::string html = TradeHtml(report), svg = TradeChart(report);
    EXPECT_EQ(Markup(html).All("figure").size(), report.variants.size());
    EXPECT_EQ(Markup(svg).All("svg").size(), 1u);
    EXPECT_EQ(html.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
  }
}

double Attribute(const Tag& tag, const std::string& name) { return std::stod(tag.attributes.at(name)); }

TEST(TradeChart, IsWellFormedOnItsOwnAndShowsEveryWayAndTheFront) {
  const TradeReport report = HostileReport();
  const std::string svg = TradeChart(report);
  const Markup chart(svg);
  EXPECT_EQ(chart.All("svg")[0].attributes.at("xmlns"), "http://www.w3.org/2000/svg");
  EXPECT_EQ(chart.All("g").size(), report.variants.size());
  EXPECT_EQ(chart.All("circle", "svg g").size(), FrontOf(report).size());
  EXPECT_EQ(chart.All("a").size(), 0u) << "it has no page to lead to";
  EXPECT_NE(svg.find("&lt;axis&gt;"), std::string::npos);
}

// A decade is as wide wherever it is, errors are to scale, and less of either is to the left and below.
TEST(TradeChart, PointsStandWhereTheirFiguresPutThem) {
  TradeReport report;
  report.variants = {MadeUpVariant("a", "1", 1.0, 4.0), MadeUpVariant("a", "2", 10.0, 3.0),
                     MadeUpVariant("a", "3", 100.0, 1.0)};
  const std::string svg = TradeChart(report);
  const std::vector<Tag> rings = Markup(svg).All("circle", "svg g");
  ASSERT_EQ(rings.size(), 3u);
  double x[3], y[3];
  for (std::size_t i = 0; i < 3; ++i) x[i] = Attribute(rings[i], "cx"), y[i] = Attribute(rings[i], "cy");
  // Places are written to 0.1, so distances are known to 0.1, and half of one to 0.05 more.
  EXPECT_GT(x[1], x[0] + 50.0);
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], 0.21);
  EXPECT_GT(y[1], y[0] + 20.0) << "less error is lower";
  EXPECT_NEAR(y[2] - y[1], 2.0 * (y[1] - y[0]), 0.31);
}

TEST(TradeChart, WaysWithoutTimeOrErrorAreNotDrawn) {
  TradeReport report = MadeUpReport();
  report.variants[1].total_ms = {};
  report.variants[2].texture = kNoNumber;
  report.variants[3].texture = std::numeric_limits<double>::infinity();
  report.variants[4].total_ms.upper = std::numeric_limits<double>::infinity();
  const std::string svg = TradeChart(report);
  EXPECT_EQ(Markup(svg).All("g").size(), 3u);
  for (const char* word : {"\"nan", "\"inf", "\"-inf"}) EXPECT_EQ(svg.find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace scumble
