// Linked into a program, this makes every function with SCUMBLE_WIDE_LOOPS take its default form. GCC's choice between
// forms asks libgcc's record of the processor, which these definitions replace: it knows no AVX2. The variable
// GLIBC_TUNABLES does not reach that choice.
extern "C" {

struct ProcessorRecord {
  unsigned vendor, type, subtype, features[1];
};
ProcessorRecord __cpu_model = {};
unsigned __cpu_features2[4] = {};
int __cpu_indicator_init() { return 0; }
}
