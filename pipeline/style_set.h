// The styles of one run: a default one, and those that --assign or the scene gives to objects and materials.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/image/guides.h"
#include "core/image/style.h"
#include "core/style/finish_chain.h"
#include "guidegen/scene.h"
#include "pipeline/requests.h"
#include "pipeline/run_context.h"
#include "pipeline/style/assignments.h"
#include "transfer/style_map.h"

namespace scumble {

struct SceneStyleRequests;

struct StyleSet {
  struct Assigned {
    NamePattern pattern;  // of an object or material
    std::uint16_t style = 0;
    std::string where;       // the option, or the file and its line, for messages
    bool named = false;      // some frame so far has such an object or material
    bool warned = false;     // that none has
    std::size_t pixels = 0;  // that it has painted in all frames so far
  };
  // One --set. "finish." keys without a style's name are those of all styles and of `finish`.
  struct Override : StyleOverride {
    std::string path;  // of its style
  };
  std::vector<Style> styles;       // the default first, never empty
  std::vector<std::string> given;  // by style: its name as the user or the scene gives it
  std::vector<Assigned> assigned;
  std::vector<Override> overrides;
  std::map<std::string, std::uint16_t> wanted;  // by the scene, with the folder of its file; goes after `assigned`
  StyleRequest options;                         // that it was opened with
  RunContext context;                           // likewise
  std::size_t chosen = 1;                       // so many of `styles` are the user's, the others the scene's
  std::map<std::string, std::uint16_t> opened;  // by path
  FinishChain finish;                           // of StyleRequest::finishes

  const Style& first() const { return styles.front(); }
  // Whether any pixel of these guides, which are `file`'s, may have another style than the default.
  bool NeedsMap(const GuideSet& guides, const std::string& file) const;
  // The layers that say which object or material a pixel belongs to, where that matters. One of them may do.
  LayerSet LayersOfNames(const SceneStyleRequests& requests) const;
};

// The styles that a scene's author asks for, by the name of the object or material. From a scene: of the instances, and
// of materials in use.
struct SceneStyleRequests {
  std::map<std::string, std::string> objects;
  std::map<std::string, std::string> materials;
};
SceneStyleRequests SceneStyleRequestsOf(std::span<const Instance> instances, const Scene& scene);
SceneStyleRequests SceneStyleRequestsOf(const GuideSet& guides);

// The names of the styles that StyleLayers opens for these requests, in its order, where `patterns` are those of
// --assign.
std::vector<std::string> StylesAskedFor(const SceneStyleRequests& requests, std::span<const NamePattern> patterns);

// Opens the styles that are asked for, unless --assign decides or StyleRequest::scene_styles is off. Returns the layers
// that the user's styles and these read, in any frame. Paths are relative to the folder of `file`, the scene or guide
// file that asks. A kInput error names the object.
Expected<LayerSet> StyleLayers(StyleSet& set, const SceneStyleRequests& requests, const std::string& file);

// StyleLayers and LayersOfNames: what guides must be made with.
Expected<LayerSet> RequiredLayers(StyleSet& set, const SceneStyleRequests& requests, const std::string& file);

// The fewest options of edges and repetition, "--set transfer.edge_aware=false --set transfer.variety=0", with which
// the open styles read none of these layers. Empty where more than these options reads them.
std::string SetsWithout(const StyleSet& set, const LayerSet& layers);

// Drops the styles that a scene asked for, before another scene is painted.
void CloseSceneStyles(StyleSet& set);

// Opens the default style and every assigned one, each once. "rendered" leaves objects as they are, "catcher" shows
// nothing of them but the shadows on them, "catcher-or-rendered" is "catcher" where the default style paints shadows,
// otherwise "rendered". Cancelled between two styles.
Expected<StyleSet> OpenStyles(const StyleRequest& options, const RunContext& context);

// Which style paints which pixel, by the names in the guides, which are `file`'s. The last assignment that fits a
// pixel's object or material wins. Without any, it is what the scene asks for, an object before its material. A pattern
// that fits nothing is warned of once in all frames; it is kInput where the guides lack the layer in which it might.
Expected<StyleMap> MapStyles(StyleSet& set, const GuideSet& guides, const std::string& file);

// After the last frame: warns of assignments that have painted no pixel.
void WarnOfIdleAssignments(const StyleSet& set);

}  // namespace scumble
