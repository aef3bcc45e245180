#include "pipeline/run_context.h"

#include <system_error>

#include "pipeline/stage_clock.h"

namespace scumble {

void RunContext::Note(const std::string& text) const {
  if (on_message) on_message({Message::Kind::kNote, text});
}

void RunContext::Warn(const std::string& text) const {
  if (on_message) on_message({Message::Kind::kWarning, text});
}

Status RunContext::CheckNotCancelled() const {
  return is_cancelled && is_cancelled() ? Status(CancelledError()) : Ok();
}

void RunContext::EndStage(const std::string& name, const std::vector<std::pair<std::string, double>>& inside) const {
  if (clock) clock->End(name, inside);
}

RunContext RunContext::WithoutNotes() const {
  RunContext quiet = *this;
  quiet.clock.reset();
  quiet.on_progress = nullptr;
  quiet.noted_memory.reset(), quiet.noted_light_noise.reset();
  if (on_message) {
    quiet.on_message = [tell = on_message](const Message& message) {
      if (message.kind == Message::Kind::kWarning) tell(message);
    };
  }
  return quiet;
}

std::vector<std::filesystem::path> RunContext::DataFolders(const std::string& name) const {
  std::vector<std::filesystem::path> folders;
  std::error_code failed;
  for (const std::filesystem::path& root : data_roots) {
    if (std::filesystem::is_directory(root / name, failed)) folders.push_back(root / name);
  }
  return folders;
}

}  // namespace scumble
