#include <scumble/scumble.h>

#include <cstdio>

int main(int count, char** arguments) {
  if (count != 4) return std::puts("usage: paint SCENE STYLE PICTURE"), 2;
  scumble::Stylizer stylizer;
  const scumble::SceneSettings scene{.file = arguments[1], .width = 640, .height = 360};
  const scumble::StyleSettings style{.style = arguments[2]};

  const auto picture = stylizer.Paint(scene, style);
  if (!picture) return std::puts(picture.error().message.c_str()), 1;

  const auto saved = scumble::SavePicture(arguments[3], *picture);
  if (!saved) return std::puts(saved.error().message.c_str()), 1;
}
