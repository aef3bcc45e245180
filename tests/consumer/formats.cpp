// A program that reads and writes pictures of other formats, and makes no Stylizer.
#include <scumble/picture.h>

#include <cstdio>

int main(int count, char** arguments) {
  if (count != 3) return std::puts("usage: formats FROM TO"), 2;
  const auto picture = scumble::LoadPicture(arguments[1]);
  if (!picture) return std::puts(picture.error().message.c_str()), 1;

  const auto saved = scumble::SavePicture(arguments[2], *picture);
  if (!saved) return std::puts(saved.error().message.c_str()), 1;
}
