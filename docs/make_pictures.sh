#!/usr/bin/env bash
# Regenerates docs/*.svg: runs the examples with the program in the given build folder and draws their results. make_pictures.sh BUILD_FOLDER
set -euo pipefail
build=$(realpath "${1:?'usage: make_pictures.sh BUILD_FOLDER'}")
top=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
data=$(mktemp -d)
trap 'rm -rf "$data"' EXIT

# picture NAME FILE [ARGS]: the result of `tfc run examples/FILE ARGS`, drawn as docs/pictures/NAME.plot says, in docs/NAME.svg.
picture() {
  local name=$1 file=$2
  shift 2
  "$build/tfc" run "$top/examples/$file" --quiet "$@" -o "$data/$name.csv"
  "$build/tf_plot" "$top/docs/pictures/$name.plot" "$data" "$top/docs/$name.svg"
}

picture particle particle.tf --set mu=0.6 --set 'u[1]=7' --set 'u[2]=if time < 1 then 0 else 2*g*(time-1)' --stop-time 2 --interval 0.005
picture falling_box falling_box.tf --interval 0.005
picture falling_rod falling_rod.tf --interval 0.005
picture chain chain.tf --interval 0.002
picture stickslip stickslip.tf --stop-time 10 --interval 0.01
picture den_hartog den_hartog.tf --interval 0.02
picture moving_ground moving_ground.tf --interval 0.002
picture pushed_block pushed_block.tf --interval 0.005
picture particle3d particle3d.tf --interval 0.005
picture dragged_table dragged_table.tf --interval 0.01
picture backspin_ball backspin_ball.tf --interval 0.005
picture woodpecker woodpecker.tf --stop-time 1 --interval 0.0005

# simulate NAME FILE [ARGS]: a result for a picture that several examples share; draw NAME: such a picture.
simulate() {
  local name=$1 file=$2
  shift 2
  "$build/tfc" run "$top/examples/$file" --quiet "$@" -o "$data/$name.csv"
}
draw() { "$build/tf_plot" "$top/docs/pictures/$1.plot" "$data" "$top/docs/$1.svg"; }

simulate bouncing_ball bouncing_ball.tf --interval 0.005
simulate superball superball.tf --stop-time 2 --interval 0.002
simulate rocking_block rocking_block.tf --interval 0.005
draw impacts
simulate slow_wheel rimless_wheel.tf --interval 0.01
simulate fast_wheel rimless_wheel.tf --set w=3 --interval 0.01
draw rimless_wheel
simulate painleve_rod painleve_rod.tf --interval 0.001
draw painleve
simulate newtons_cradle newtons_cradle.tf --interval 0.002
simulate column column.tf --stop-time 0.5 --interval 0.0005
draw collisions
simulate two_walls two_walls.tf --interval 0.01
simulate pendulum_wall pendulum_wall.tf --interval 0.01
simulate double_pendulum double_pendulum.tf --stop-time 1 --interval 0.01
draw walls
simulate three_carts three_carts.tf --interval 0.01
simulate carts carts.tf --interval 0.01
draw carts
simulate spinning_top spinning_top.tf --stop-time 1 --interval 0.002
simulate nodding_top spinning_top.tf --set 'R.w[3]=60' --stop-time 1 --interval 0.002
simulate tippe_top tippe_top.tf --interval 0.002
draw tops
simulate four_bar four_bar.tf --stop-time 0.6 --interval 0.01
simulate slider_crank slider_crank.tf --interval 0.0001
draw mechanisms
simulate tumbling_box tumbling_box.tf --interval 0.005
simulate tumbling_box_begin tumbling_box.tf --stop-time 1.4 --interval 0.01
draw tumbling_box
simulate relay relay.tf --interval 0.01
simulate thermostat thermostat.tf --interval 0.05
simulate incline incline.tf --interval 0.005
simulate incline_stays incline.tf --set mu=0.7 --interval 0.005
simulate corner corner.tf --interval 0.005
draw switches

# Errors of fixed-step runs, measured by the accuracy tests against an independent reference.
if [ -x "$build/tests/accuracy/accuracy_test" ]; then
  TF_ORDER_TABLE=$data "$build/tests/accuracy/accuracy_test" --gtest_filter='*Order*' >/dev/null
  "$build/tf_plot" "$top/docs/pictures/order.plot" "$data" "$top/docs/order.svg"
fi
