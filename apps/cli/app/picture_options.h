// Options of commands that paint: the picture, its frames, and its time limit.
#pragma once

#include <optional>
#include <string>

#include "apps/cli/app/options.h"
#include "pipeline/budget_choice.h"
#include "pipeline/requests.h"

namespace scumble {

struct PictureOptions {
  PictureRequest request;
  std::string fps;
  std::string exposure = "auto";
  std::string show;
};
// --show and --layers-out, of which `show` holds the text. `explanations`: besides finish:NAME, ExplanationNames() can
// be shown.
void AddShowOptions(CLI::App& verb, std::string& show, std::string& layers_out, bool explanations);
// NAME of finish:NAME; empty for anything else.
std::string ShownFinish(const std::string& show);

// `needed`: the command requires an output.
void AddPictureOptions(CLI::App& verb, PictureOptions& options, bool needed);
// Chunks are measured if the report is JSON, which has room for them.
Expected<PictureRequest> ToRequest(const PictureOptions& options, const Globals& globals);

struct SequenceOptions {
  std::string frames;  // as ParseFrames takes them; empty: one picture, no sequence
  bool resume = false;
};
void AddSequenceOptions(CLI::App& verb, SequenceOptions& options);
Expected<SequenceRequest> ToRequest(const SequenceOptions& options);

struct BudgetOptions {
  BudgetRequest request;
  std::string quality;
};
// `casts`: the command makes its guides itself. Call it after AddPictureOptions.
void AddBudgetOptions(CLI::App& verb, BudgetOptions& options, bool casts);
// Checks the given options; a usage error where they exclude each other.
Expected<BudgetRequest> ToRequest(const CLI::App& verb, const BudgetOptions& options);

}  // namespace scumble
