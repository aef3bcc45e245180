// The two files of `scumble compare`, channel by channel.
#pragma once

#include "apps/cli/verbs/compare_verb.h"
#include "core/image/channel_image.h"

namespace scumble {

struct ComparedFiles {
  ChannelImage a, b;
};

// Reads both files: as stored, by channel name. If they have no channel name in common, or a view layer is chosen, they
// are read as guides, with the conversions of ReadGuides, and the layers that both hold are compared. Then notes name
// these layers, and those that only one of them holds.
Expected<ComparedFiles> ReadToCompare(const CompareVerb& verb, const Globals& globals);

}  // namespace scumble
