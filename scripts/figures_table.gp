# SPDX-License-Identifier: GPL-3.0-or-later
# The closed forms of Table 1 of the STD paper's supplement against FILE (gamma,theta,D,G1,D anisotropic of stdfit ndf):
# largest differences, as CSV. Lambda of 7/2 as it should be, and as it is printed.
file = system("printenv FILE")
set datafile separator ","
set print "-"
set angles degrees
s = 0.5; sx = 0.5; sy = 0.2; phi = 30.
q(t) = tan(t)**2 / s**2
q_axes(t) = tan(t)**2 * (cos(phi)**2 / sx**2 + sin(phi)**2 / sy**2)
front(t) = 1 / (pi * s**2 * cos(t)**4)
front_axes(t) = 1 / (pi * sx * sy * cos(t)**4)
arctan(x) = atan(x) * pi / 180
g_of(g, q) = g == 2 ? (1 + q)**-2 : g == 2.5 ? (1 + 2 * q / 3)**-2.5 : g == 3 ? 8 * (2 + q)**-3 : \
	g == 3.5 ? (1 + 2 * q / 5)**-3.5 : g == 4 ? 81 * (3 + q)**-4 : exp(-q)
D(g, t) = front(t) * g_of(g, q(t))
D_axes(g, t) = front_axes(t) * g_of(g, q_axes(t))
lambda(g, m) = \
	g == 2 ? (sqrt(m**2 + s**2) / m - 1) / 2 : \
	g == 2.5 ? arctan(sqrt(2. / 3) * m / s) / pi - 0.5 + sqrt(1.5) * s / (pi * m) : \
	g == 3 ? ((m**4 + 3 * m**2 * s**2 + 2 * s**4) / (m * (m**2 + 2 * s**2)**1.5) - 1) / 2 : \
	g == 3.5 ? arctan(sqrt(0.4) * m / s) / pi - 0.5 + \
		sqrt(2.5) * 2 * s * (3 * m**2 + 5 * s**2) / (3 * pi * m * (2 * m**2 + 5 * s**2)) : \
	g == 4 ? ((8 * m**6 + 60 * m**4 * s**2 + 135 * m**2 * s**4 + 81 * s**6) / (8 * m * (m**2 + 3 * s**2)**2.5) - 1) / 2 : \
	(s * exp(-m**2 / s**2) / (m * sqrt(pi)) + erf(m / s) - 1) / 2
printed(m) = arctan(sqrt(0.4) * m / s) / (3 * pi) - 1 + \
	5 * sqrt(2.5) * (-6 * m**4 + 17 * m**2 * s**2 + 8 * s**4) / (6 * pi * m * s * (2 * m**2 + 5 * s**2))
gamma_at(text) = text eq "inf" ? 1e9 : real(text)
print "gamma,what,largest_difference"
do for [text in "2 2.5 3 3.5 4 inf"] {
	g = gamma_at(text)
	stats file using (strcol(1) eq text ? abs(D(g, $2) / $3 - 1) : NaN) nooutput
	print sprintf("%s,D,%.3g", text, STATS_max)
	stats file using (strcol(1) eq text ? abs(D_axes(g, $2) / $5 - 1) : NaN) nooutput
	print sprintf("%s,D anisotropic,%.3g", text, STATS_max)
	stats file using (strcol(1) eq text ? abs(1 / (1 + lambda(g, 1 / tan($2))) - $4) : NaN) nooutput
	print sprintf("%s,Lambda (as G1),%.3g", text, STATS_max)
}
stats file using (strcol(1) eq "3.5" ? abs(1 / (1 + printed(1 / tan($2))) - $4) : NaN) nooutput
print sprintf("3.5,Lambda as printed,%.3g", STATS_max)
