set -eu
cd /work/main
step() { printf "== %s (%s)\n" "$*" "$(date +%H:%M)"; }
# The tests of a program that a filter names, in eight processes: a sanitized program takes long to start.
sanitized() {
  seq 0 7 | xargs -P 3 -I{} env GTEST_TOTAL_SHARDS=8 GTEST_SHARD_INDEX={} "$1" --gtest_brief=1 --gtest_filter="$2"
}
export ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1:allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS=suppressions=$PWD/tests/tsan.supp:halt_on_error=1
step "asan: build and test"
# Without the longest tests, whose time goes into libraries or into whole pictures; of the program, what reads input.
sanitized build/asan/foci_tests '-*Aberration*:Alignment.*:Auto*.*Predict*:AutoTest.APassed*:AutoTest.RendersSub*:AutoTest.Spreads*:CascadeTracker.F*:ClosedSurfaces.*:*Ellipses.*raytrace*:FaceFinder.FindsBoth*:FaceNetworks.TheIris*:Fidelity.A*:Framing.AS*:*GaussianCaptures*:GltfLimits.I*:*GpuCapture*:GpuGaussianPicture.*:GpuPicture.*:GpuWindows.Larger*:HardFaces.*:HeatMap.OfG*:KeptFrame.TheTexture*:Label*.Agrees*:Label*.IsNotWorse*:LevelKernels.*:MakeStatue.*:Mulder.P*:*NetworkTracker.*:PartsOfAMesh.*:PlanChart.H*:PrepareScene.*:Raytrace.A*:RenderImage.*:SurfaceQuery.F*:SurfelsFromPoints.*:SweepLod.*'
sanitized build/asan/foci_e2e '*BadInputs*:BadUsage*:Batch.Refuse*:Calibrat*:Figures*:HostileInputs*:Overwrite*:Recordings*:Replay.*:ReplayOfAH*:ReplayOfE*:Trace*-HostileInputs.AMeshHasLimits'


echo ASAN_OK
