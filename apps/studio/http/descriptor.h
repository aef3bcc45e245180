// A descriptor of a file or a socket that closes itself.
#pragma once

#include <unistd.h>

#include <utility>

namespace scumble {

class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept { return std::swap(number_, other.number_), *this; }
  int number() const { return number_; }

 private:
  int number_;
};

}  // namespace scumble
