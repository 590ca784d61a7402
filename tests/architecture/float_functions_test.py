"""Holds the libraries against float functions of the C library whose last bit depends on its version.

    float_functions_test.py NM LIBRARY...

Frames have the same bytes on every system. The functions below changed between glibc 2.36 and 2.41. Their double
versions did not; sinf, cosf, expf, logf, powf and hypotf did not either.
"""

import re
import subprocess
import sys

CHANGED = re.compile(r"^(acos|asin|atan|atan2|acosh|asinh|atanh|cbrt|cosh|erf|erfc|exp10|expm1|lgamma|log10|log1p|sinh|tan|"
                     r"tanh|tgamma)f$")


def changed_functions(names):
    return sorted({name for name in names if CHANGED.match(name)})


def main():
    assert changed_functions(["atan2f", "sinf", "atan2", "hypotf"]) == ["atan2f"]
    nm, *libraries = sys.argv[1:]
    for library in libraries:
        symbols = subprocess.run([nm, "--undefined-only", library], capture_output=True, text=True, check=True).stdout.split()
        if "U" not in symbols:
            sys.exit(f"{library}: nm lists no symbols")
        if found := changed_functions(symbols):
            sys.exit(f"{library} calls {', '.join(found)}: their last bit depends on the C library; compute in double")
    print(f"{len(libraries)} libraries call no float function that changed.")


main()
