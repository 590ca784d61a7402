#include <cstdio>

int main() {
  std::puts("foci");
  return 0;
}
